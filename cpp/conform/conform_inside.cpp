#include "conform/conform_inside.h"

#include "base/random.h"
#include "conform/circumspheres.h"

#include <algorithm>
#include <array>

namespace wct::conform {

namespace {

/// The pinned points, then those inside that are no corners of kept tets alone.
sampling::Cloud own_points(const refill::PinnedFacets &facets, const domain::InputMesh &mesh,
                           std::span<const double> size) {
    sampling::Cloud cloud;
    std::vector<char> taken(mesh.points.size(), 0);
    for (const int v : facets.points()) {
        cloud.add(mesh.points[v], Stratum::corner, v, size[v]);
        taken[v] = 1;
    }
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
        for (const int v : mesh.tets[t])
            if (facets.keeps(static_cast<int>(t)))
                taken[v] = 1;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
        for (const int v : mesh.tets[t])
            if (!taken[v]) {
                cloud.add(mesh.points[v], Stratum::interior, mesh.region[t], size[v]);
                taken[v] = 1;
            }
    return cloud;
}

/// Ties and circumcenters beyond a facet where a region ends, counted; points inside are moved, added or dropped
/// against them.
class Untier {
  public:
    Untier(sampling::Cloud &cloud, const sampling::RestrictedDelaunay &complex, const domain::RegionMap &map,
           const ConformOptions &options, Random &random)
        : cloud_(cloud), complex_(complex), map_(map), options_(options), random_(random), spheres_(cloud, complex) {
        spheres_.measure();
    }

    /// Count all, mend this share of them.
    std::size_t run(double share) {
        std::size_t faults = 0;
        std::vector<char> keep(cloud_.count(), 1);
        for (int t = 0; t < static_cast<int>(spheres_.size()); ++t)
            for (int i = 0; i < 4; ++i) {
                const int next = complex_.all.neighbours[t][i];
                if (complex_.region[t] < 0)
                    continue;
                if (next < 0 || complex_.region[next] != complex_.region[t]) {
                    const int apex = complex_.all.tets[t][i];
                    if (spheres_.height(t, i) > options_.least * spheres_[t].radius)
                        continue;
                    ++faults;
                    keep[apex] = cloud_.role[apex] != Stratum::interior;
                } else if (next > t) {
                    if (!spheres_.tied(t, i, options_.least))
                        continue;
                    ++faults;
                    if (random_.uniform() < share)
                        part(t, i, complex_.apex_beyond(t, i));
                }
            }
        keep.resize(cloud_.count(), 1);
        cloud_.keep(keep);
        return faults;
    }

  private:
    void part(int t, int i, int other) {
        constexpr double step = 0.03, off = 0.1; // in sizes
        const auto f = complex_.facet(t, i);
        std::vector<int> free;
        for (const int v : {f[0], f[1], f[2], complex_.all.tets[t][i], other})
            if (cloud_.role[v] == Stratum::interior)
                free.push_back(v);
        if (!free.empty()) {
            const int v = free[random_.below(static_cast<int>(free.size()))];
            cloud_.points[v] += step * cloud_.size[v] * random_.normal3();
        } else if (map_.region(spheres_[t].center, -1) == complex_.region[t]) {
            const double size = (cloud_.size[f[0]] + cloud_.size[f[1]] + cloud_.size[f[2]]) / 3.0;
            cloud_.add(spheres_[t].center + off * size * random_.uniform() * unit(random_.normal3()), Stratum::interior,
                       complex_.region[t], size);
        }
    }

    sampling::Cloud &cloud_;
    const sampling::RestrictedDelaunay &complex_;
    const domain::RegionMap &map_;
    const ConformOptions &options_;
    Random &random_;
    Circumspheres spheres_;
};

refill::Refilled between(const refill::PinnedFacets &facets, const domain::InputMesh &mesh,
                         const domain::RegionMap &map, std::span<const double> size, const ConformOptions &options,
                         Monitor &monitor) {
    constexpr double least = 0.05; // distance of points inside, in sizes
    const refill::Keeper keeper(facets, mesh, least);
    Random random(options.seed);
    sampling::Cloud cloud = own_points(facets, mesh, size);
    sampling::RestrictedDelaunay complex;
    refill::Refilled best;
    sampling::Cloud sound; // the last with all facets
    std::size_t fewest = 0;
    double share = 1.0;
    int since = 0;
    for (int round = 0;
         round < options.effort * options.rounds && since < options.effort * options.patience && !monitor.stopped();
         ++round) {
        keeper.clear(cloud);
        ++since;
        if (keeper.triangulate(cloud, complex)) {
            sound = cloud;
        } else if (best.tets.empty()) {
            break;
        } else { // points that were moved let go of a square: move fewer
            share *= 0.5;
            cloud = sound;
            keeper.triangulate(cloud, complex);
        }
        const std::size_t faults = options.one_sided ? Untier(cloud, complex, map, options, random).run(share) : 0;
        if (best.tets.empty() || faults < fewest) {
            best = refill::merged(sound, complex, facets, mesh, size);
            fewest = faults;
            since = 0;
        }
        monitor.set_bad(static_cast<std::int64_t>(fewest));
        monitor.report(static_cast<double>(round) / (options.effort * options.rounds)); // a round takes long
        if (faults == 0)
            break;
    }
    return best;
}

} // namespace

refill::Refilled conform_inside(const domain::Reference &reference, const domain::InputMesh &mesh,
                                const std::vector<char> &pinned, std::span<const Edge> edges,
                                std::span<const double> size, const ConformOptions &options, Monitor &monitor) {
    return refill::fill_between(reference, mesh, pinned, edges, monitor,
                                [&](const refill::PinnedFacets &facets, const domain::RegionMap &map) {
                                    return between(facets, mesh, map, size, options, monitor);
                                });
}

} // namespace wct::conform
