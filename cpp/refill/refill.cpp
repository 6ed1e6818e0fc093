#include "refill/refill.h"

#include "sampling/cloud.h"
#include "sampling/cloud_descent.h"
#include "sampling/odt_relaxation.h"
#include "sampling/tet_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

namespace wct::refill {

namespace {

/// The pinned points and a lattice between them.
sampling::Cloud seeds(const PinnedFacets &facets, const domain::Reference &reference, const domain::InputMesh &mesh,
                      const domain::RegionMap &map, const domain::Sizing &sizing, const sampling::SeedForm &form,
                      Random &random, Monitor &monitor, const Workers &workers) {
    sampling::Cloud cloud;
    for (const int v : facets.points())
        cloud.add(mesh.points[v], Stratum::corner, v, sizing.at(mesh.points[v]));
    sampling::seed_inside(cloud, reference, map, sizing, form, {}, random, monitor, workers);
    if (monitor.stopped())
        return cloud;
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

/// The input that is filled anew, and how.
struct Filling {
    const PinnedFacets &facets;
    const domain::Reference &reference;
    const domain::InputMesh &mesh;
    const domain::RegionMap &map;
    const RefillOptions &options;
    Monitor &monitor;
    const Workers &workers;
    Keeper keeper;
    std::optional<domain::Sizing> sizing{};
    sampling::Cloud cloud{};
    sampling::RestrictedDelaunay complex{};
};

/// How many times the tets that there may be.
double share_of(const Filling &fill, double tets) {
    return tets / (fill.options.most * static_cast<double>(fill.mesh.tets.size()));
}

/// Ask for sizes, larger and larger until about as many tets are to be expected as a lattice may be laid for. False if
/// whoever hears of them wants none, or if surfaces so close together ask for so many that larger sizes elsewhere do
/// not help.
bool choose_sizes(Filling &fill, domain::SizingForm &sizes, std::span<const double> wanted) {
    constexpr double laid = 4.0; // a lattice for so many times the tets that there may be is laid and counted: more is
                                 // work thrown away, and less is not known so well before
    constexpr double gain = 0.7; // of the tets that are left after a step which helps
    for (double before = std::numeric_limits<double>::infinity();;) {
        fill.sizing.emplace(fill.reference, fill.mesh, fill.map, sizes, wanted, fill.workers);
        const double tets = sampling::estimate_tets(fill.reference, fill.mesh, *fill.sizing, fill.workers);
        if (std::isinf(before) && fill.options.expected && !fill.options.expected(tets))
            return false;
        const double share = share_of(fill, tets);
        if (share <= laid)
            return true;
        if (share > gain * before)
            return false;
        before = share;
        sizes.coarsen *= std::cbrt(share);
    }
}

/// Seed points, fewer and fewer until there are not too many tets, and triangulate them; false if a facet is missing,
/// too many tets are expected, or it was stopped.
bool seed(Filling &fill, std::span<const double> wanted) {
    constexpr int tries = 5;
    constexpr double spare = 1.02; // sizes grow by so much more than the number of tets asks for
    const RefillOptions &options = fill.options;
    Random random(options.seed);
    domain::SizingForm sizes;
    sizes.tolerance = sizes.thickness = 1e100; // the surface does not change: neither bend nor thickness matters,
    sizes.sharp = false;                       // nor how sharp its edges are
    sizes.coarsen = options.size;
    if (!choose_sizes(fill, sizes, wanted))
        return false;
    for (int k = 0; k < tries; ++k) {
        fill.cloud = seeds(fill.facets, fill.reference, fill.mesh, fill.map, *fill.sizing, options.seeds, random,
                           fill.monitor, fill.workers);
        if (fill.monitor.stopped())
            return false;
        fill.keeper.clear(fill.cloud);
        if (!fill.keeper.triangulate(fill.cloud, fill.complex))
            return false;
        const double share = share_of(fill, static_cast<double>(tets_of(fill.complex) + fill.facets.kept()));
        if (share <= 1.0)
            break;
        sizes.coarsen *= spare * std::cbrt(share);
        fill.sizing.emplace(fill.reference, fill.mesh, fill.map, sizes, wanted, fill.workers);
    }
    return true;
}

/// Spread the points evenly for their sizes; false if a facet is missing.
bool relax(Filling &fill) {
    constexpr int renewed = 8; // sweeps after which sizes are asked for anew
    const RefillOptions &options = fill.options;
    for (int sweep = 0; sweep < options.sweeps && !fill.monitor.stopped(); ++sweep) {
        if (sweep > 0 && !fill.keeper.triangulate(fill.cloud, fill.complex))
            return false;
        sampling::relax(fill.cloud, fill.reference, fill.complex, options.step, 0.0, fill.workers);
        fill.keeper.clear(fill.cloud);
        if (sweep % renewed == renewed - 1)
            for (std::size_t i = 0; i < fill.cloud.count(); ++i)
                fill.cloud.size[i] = fill.sizing->at(fill.cloud.points[i]);
        fill.monitor.work(fill.complex.all.tets.size(), 0.5 * sweep / options.sweeps);
    }
    return true;
}

/// Move the points downhill, and triangulate them anew, as long as that brings fewer bad tets; returns the mesh with
/// fewest.
Refilled descend(Filling &fill) {
    constexpr int vain = 4; // rounds without fewer bad tets after which it ends
    const RefillOptions &options = fill.options;
    energy::EnergyForm energy = options.energy;
    if (!options.cosines)
        energy.weight2 = 0.0;
    Refilled best;
    std::size_t least = 0;
    int since = 0;
    for (int round = 0; round <= options.rounds && !fill.monitor.stopped() && since <= vain; ++round) {
        if (!fill.keeper.triangulate(fill.cloud, fill.complex))
            break;
        const sampling::Tally tally = sampling::count_bad(fill.cloud, fill.complex, options.cosines);
        if (best.tets.empty() || tally.bad < least) {
            least = tally.bad;
            std::vector<double> size;
            for (const Vec3 &p : fill.mesh.points)
                size.push_back(fill.sizing->at(p));
            best = merged(fill.cloud, fill.complex, fill.facets, fill.mesh, size);
            since = 0;
        } else {
            ++since;
        }
        fill.monitor.set_bad(static_cast<std::int64_t>(least));
        const std::vector<Vec3> direction(fill.cloud.count());
        const std::vector<char> curved(fill.cloud.count(), 0);
        const std::size_t evaluations =
            sampling::descend(fill.cloud, fill.complex, direction, energy, sampling::EdgeForm{.weight = 0.0}, curved,
                              sampling::FitForm{}, {}, {options.iterations, options.reach}, fill.workers);
        fill.keeper.clear(fill.cloud);
        fill.monitor.work(evaluations, 0.5 + 0.5 * round / options.rounds);
    }
    best.stopped = fill.monitor.stopped();
    return best;
}

} // namespace

Refilled refill(const domain::Reference &reference, const domain::InputMesh &mesh, const std::vector<char> &pinned,
                std::span<const Edge> edges, std::span<const double> wanted, const RefillOptions &options,
                Monitor &monitor, const Workers &workers) {
    constexpr double apart = 0.35; // distance of new points, in sizes
    return fill_between(
        reference, mesh, pinned, edges, monitor, [&](const PinnedFacets &facets, const domain::RegionMap &map) {
            Filling fill{facets, reference, mesh, map, options, monitor, workers, Keeper(facets, mesh, apart)};
            return seed(fill, wanted) && relax(fill) ? descend(fill) : Refilled{};
        });
}

} // namespace wct::refill
