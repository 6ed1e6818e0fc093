#include "refill/refill.h"

#include "sampling/cloud.h"
#include "sampling/cloud_descent.h"
#include "sampling/odt_relaxation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

namespace wct::refill {

namespace {

/// The pinned points and a lattice between them.
sampling::Cloud seeds(const PinnedFacets &facets, const domain::Reference &reference, const domain::InputMesh &mesh,
                      const domain::RegionMap &map, const domain::Sizing &sizing, const sampling::SeedForm &form,
                      Random &random) {
    sampling::Cloud cloud;
    for (const int v : facets.points())
        cloud.add(mesh.points[v], Stratum::corner, v, sizing.at(mesh.points[v]));
    sampling::seed_inside(cloud, reference, map, sizing, form, {}, random);
    std::vector<char> open(cloud.count(), 1);
    for (std::size_t i = facets.points().size(); i < cloud.count(); ++i) {
        const domain::Place place = map.find(cloud.points[i]);
        open[i] = place.tet >= 0 && !facets.keeps(place.tet);
    }
    cloud.keep(open);
    return cloud;
}

std::size_t tets_of(const sampling::RestrictedDelaunay &complex) {
    return static_cast<std::size_t>(
        std::count_if(complex.region.begin(), complex.region.end(), [](int region) { return region >= 0; }));
}

/// Empty where not all facets come out.
Refilled fill(const PinnedFacets &facets, const domain::Reference &reference, const domain::InputMesh &mesh,
              const domain::RegionMap &map, std::span<const double> wanted, const RefillOptions &options,
              Monitor &monitor, const Workers &workers) {
    constexpr double apart = 0.35; // distance of new points, in sizes
    const Keeper keeper(facets, mesh, apart);
    Random random(options.seed);
    sampling::Cloud cloud;
    sampling::RestrictedDelaunay complex;
    domain::SizingForm sizes;
    sizes.tolerance = sizes.thickness = 1e100; // the surface does not change: neither bend nor thickness matters,
    sizes.sharp = false;                       // nor how sharp its edges are
    sizes.coarsen = options.size;
    std::optional<domain::Sizing> sizing;
    constexpr int tries = 5;
    for (int k = 0; k < tries; ++k) {
        sizing.emplace(reference, mesh, map, sizes, wanted, workers);
        cloud = seeds(facets, reference, mesh, map, *sizing, options.seeds, random);
        keeper.clear(cloud);
        if (!keeper.triangulate(cloud, complex))
            return {};
        const double share = static_cast<double>(tets_of(complex) + facets.kept()) /
                             (options.most * static_cast<double>(mesh.tets.size()));
        if (share <= 1.0)
            break;
        sizes.coarsen *= 1.02 * std::cbrt(share);
    }
    for (int sweep = 0; sweep < options.sweeps && !monitor.stopped(); ++sweep) {
        if (sweep > 0 && !keeper.triangulate(cloud, complex))
            return {};
        sampling::relax(cloud, reference, complex, options.step, workers);
        keeper.clear(cloud);
        if (sweep % 8 == 7)
            for (std::size_t i = 0; i < cloud.count(); ++i)
                cloud.size[i] = sizing->at(cloud.points[i]);
        monitor.work(complex.all.tets.size(), 0.5 * sweep / options.sweeps);
    }
    energy::EnergyForm energy = options.energy;
    if (!options.cosines)
        energy.weight2 = 0.0;
    Refilled best;
    std::size_t least = 0;
    int since = 0;
    for (int round = 0; round <= options.rounds && !monitor.stopped() && since <= 4; ++round) {
        if (!keeper.triangulate(cloud, complex))
            break;
        const sampling::Tally tally = sampling::count_bad(cloud, complex, options.cosines);
        if (best.tets.empty() || tally.bad < least) {
            least = tally.bad;
            std::vector<double> size;
            for (const Vec3 &p : mesh.points)
                size.push_back(sizing->at(p));
            best = merged(cloud, complex, facets, mesh, size);
            since = 0;
        } else {
            ++since;
        }
        monitor.set_bad(static_cast<std::int64_t>(least));
        const std::vector<Vec3> direction(cloud.count());
        const std::vector<char> curved(cloud.count(), 0);
        const std::size_t evaluations =
            sampling::descend(cloud, complex, direction, energy, sampling::EdgeForm{.weight = 0.0}, curved,
                              sampling::FitForm{}, {}, options.iterations, options.reach);
        keeper.clear(cloud);
        monitor.work(evaluations, 0.5 + 0.5 * round / options.rounds);
    }
    best.stopped = monitor.stopped();
    return best;
}

} // namespace

Refilled refill(const domain::Reference &reference, const domain::InputMesh &mesh, const std::vector<char> &pinned,
                std::span<const Edge> edges, std::span<const double> wanted, const RefillOptions &options,
                Monitor &monitor, const Workers &workers) {
    return fill_between(reference, mesh, pinned, edges, monitor,
                        [&](const PinnedFacets &facets, const domain::RegionMap &map) {
                            return fill(facets, reference, mesh, map, wanted, options, monitor, workers);
                        });
}

} // namespace wct::refill
