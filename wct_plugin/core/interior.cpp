#include "interior.h"

#include "cloud.h"
#include "descent.h"
#include "relax.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

namespace wct {

namespace {

/// Puts pinned points back, new ones out of the protecting balls, and drops those of them that find no place.
class Keeper {
  public:
    Keeper(const PinnedFacets &facets, const InputMesh &mesh)
        : facets_(facets), mesh_(mesh), first_(facets.points().size()) {}

    void clear(Cloud &cloud) const {
        constexpr double least = 0.35; // distance of new points, in sizes
        std::vector<char> keep(cloud.count(), 1);
        PointGrid grid;
        for (std::size_t i = 0; i < cloud.count(); ++i) {
            const double radius = least * cloud.size[i];
            if (i < first_)
                cloud.points[i] = mesh_.points[facets_.points()[i]]; // the descent rounds
            else
                keep[i] = facets_.clear(cloud.points[i]) && !grid.crowded(cloud.points[i], radius);
            if (keep[i])
                grid.add(cloud.points[i], radius);
        }
        cloud.keep(keep);
    }

    /// The tets of the points, which are cleared; points that lie outside are dropped. False if a facet is missing.
    bool triangulate(Cloud &cloud, Complex &complex) const {
        for (bool again = true; again;) {
            complex.all = delaunay(cloud.points);
            if (!facets_.label(complex, cloud.points))
                return false;
            std::vector<char> keep(cloud.count(), 0);
            std::fill_n(keep.begin(), first_, 1);
            for (std::size_t t = 0; t < complex.all.tets.size(); ++t)
                if (complex.region[t] >= 0)
                    for (const int v : complex.all.tets[t]) {
                        keep[v] = 1;
                        if (cloud.role[v] == Stratum::interior)
                            cloud.label[v] = complex.region[t];
                    }
            again = std::find(keep.begin(), keep.end(), 0) != keep.end();
            if (again)
                cloud.keep(keep);
        }
        return true;
    }

  private:
    const PinnedFacets &facets_;
    const InputMesh &mesh_;
    std::size_t first_;
};

/// The pinned points and a lattice between them.
Cloud seeds(const PinnedFacets &facets, const Reference &reference, const InputMesh &mesh, const RegionMap &map,
            const Sizing &sizing, const SeedForm &form, Random &random) {
    Cloud cloud;
    for (const int v : facets.points())
        cloud.add(mesh.points[v], Stratum::corner, v, sizing.at(mesh.points[v]));
    seed_inside(cloud, reference, map, sizing, form, random);
    std::vector<char> open(cloud.count(), 1);
    for (std::size_t i = facets.points().size(); i < cloud.count(); ++i) {
        const Place place = map.find(cloud.points[i]);
        open[i] = place.tet >= 0 && !facets.keeps(place.tet);
    }
    cloud.keep(open);
    return cloud;
}

bool coincide(std::vector<Vec3> points) {
    const auto key = [](const Vec3 &p) { return std::tie(p.x, p.y, p.z); };
    std::sort(points.begin(), points.end(), [&](const Vec3 &p, const Vec3 &q) { return key(p) < key(q); });
    return std::adjacent_find(points.begin(), points.end()) != points.end();
}

std::size_t tets_of(const Complex &complex) {
    return static_cast<std::size_t>(
        std::count_if(complex.region.begin(), complex.region.end(), [](int region) { return region >= 0; }));
}

/// The new tets and those kept.
Interior merged(const Cloud &cloud, const Complex &complex, const PinnedFacets &facets, const InputMesh &mesh,
                const Sizing &sizing) {
    Interior out;
    std::vector<int> place(mesh.points.size(), -1);
    const auto add = [&](const Vec3 &p, int origin, double size) {
        if (origin >= 0)
            place[origin] = static_cast<int>(out.points.size());
        out.points.push_back(p);
        out.origin.push_back(origin);
        out.size.push_back(size);
    };
    for (std::size_t i = 0; i < cloud.count(); ++i)
        add(cloud.points[i], cloud.role[i] == Stratum::interior ? -1 : cloud.label[i], cloud.size[i]);
    for (std::size_t t = 0; t < complex.all.tets.size(); ++t)
        if (complex.region[t] >= 0) {
            out.tets.push_back(complex.all.tets[t]);
            out.region.push_back(complex.region[t]);
        }
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        if (!facets.keeps(static_cast<int>(t)))
            continue;
        Tet tet = mesh.tets[t];
        for (int &v : tet) {
            if (place[v] < 0)
                add(mesh.points[v], v, sizing.at(mesh.points[v]));
            v = place[v];
        }
        out.tets.push_back(tet);
        out.region.push_back(mesh.region[t]);
    }
    return out;
}

/// Empty where not all facets come out.
Interior fill(const PinnedFacets &facets, const Reference &reference, const InputMesh &mesh, const RegionMap &map,
              std::span<const double> wanted, const InteriorForm &form, Monitor &monitor, const Workers &workers) {
    const Keeper keeper(facets, mesh);
    Random random(form.seed);
    Cloud cloud;
    Complex complex;
    SizingForm sizes;
    sizes.tolerance = sizes.thickness = 1e100; // the surface does not change: neither bend nor thickness matters
    sizes.coarsen = form.size;
    std::optional<Sizing> sizing;
    constexpr int tries = 5;
    for (int k = 0; k < tries; ++k) {
        sizing.emplace(reference, mesh, map, sizes, wanted, workers);
        cloud = seeds(facets, reference, mesh, map, *sizing, form.seeds, random);
        keeper.clear(cloud);
        if (!keeper.triangulate(cloud, complex))
            return {};
        const double share =
            static_cast<double>(tets_of(complex) + facets.kept()) / (form.most * static_cast<double>(mesh.tets.size()));
        if (share <= 1.0)
            break;
        sizes.coarsen *= 1.02 * std::cbrt(share);
    }
    for (int sweep = 0; sweep < form.sweeps && !monitor.stopped(); ++sweep) {
        if (sweep > 0 && !keeper.triangulate(cloud, complex))
            return {};
        relax(cloud, reference, complex, form.step, workers);
        keeper.clear(cloud);
        if (sweep % 8 == 7)
            for (std::size_t i = 0; i < cloud.count(); ++i)
                cloud.size[i] = sizing->at(cloud.points[i]);
        monitor.work(complex.all.tets.size(), 0.5 * sweep / form.sweeps);
    }
    EnergyForm energy = form.energy;
    if (!form.cosines)
        energy.weight2 = 0.0;
    Interior best;
    std::size_t least = 0;
    int since = 0;
    for (int round = 0; round <= form.rounds && !monitor.stopped() && since <= 4; ++round) {
        if (!keeper.triangulate(cloud, complex))
            break;
        const Tally tally = count_bad(cloud, complex, form.cosines);
        if (best.tets.empty() || tally.bad < least) {
            least = tally.bad;
            best = merged(cloud, complex, facets, mesh, *sizing);
            since = 0;
        } else {
            ++since;
        }
        monitor.set_bad(static_cast<std::int64_t>(least));
        const std::vector<Vec3> direction(cloud.count());
        const std::vector<char> curved(cloud.count(), 0);
        const std::size_t evaluations = descend(cloud, complex, direction, energy, EdgeForm{.weight = 0.0}, curved,
                                                FitForm{}, {}, form.iterations, form.reach);
        keeper.clear(cloud);
        monitor.work(evaluations, 0.5 + 0.5 * round / form.rounds);
    }
    best.stopped = monitor.stopped();
    return best;
}

} // namespace

Interior refill(const Reference &reference, const InputMesh &mesh, const std::vector<char> &pinned,
                std::span<const Edge> edges, std::span<const double> wanted, const InteriorForm &form, Monitor &monitor,
                const Workers &workers) {
    if (coincide(mesh.points)) // as where sheets touch: no triangulation tells them apart
        return {};
    const RegionMap map(mesh, reference);
    Interior interior;
    for (const bool squares : {true, false}) {
        if (!interior.tets.empty() || monitor.stopped())
            break;
        const PinnedFacets facets(mesh, reference.data().triangles, pinned, edges, squares);
        if (!facets.keeps_all())
            interior = fill(facets, reference, mesh, map, wanted, form, monitor, workers);
    }
    interior.stopped = monitor.stopped();
    return interior;
}

} // namespace wct
