#pragma once

#include "base/cells.h"
#include "base/monitor.h"
#include "domain/region_map.h"
#include "refill/pinned_facets.h"
#include "sampling/cloud.h"
#include "sampling/restricted_delaunay.h"

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace wct::refill {

/// A mesh between pinned facets.
struct Refilled {
    std::vector<Vec3> points;
    std::vector<int> origin; // per point: the input's, -1 for new ones
    std::vector<double> size;
    std::vector<Tet> tets;
    std::vector<int> region;
    bool stopped = false;
};

/// Puts pinned points back, new ones out of the protecting balls, and drops those of them that find no place.
class Keeper {
  public:
    /// `least`: distance of the points inside, in sizes.
    Keeper(const PinnedFacets &facets, const domain::InputMesh &mesh, double least)
        : facets_(facets), mesh_(mesh), first_(facets.points().size()), least_(least) {}

    void clear(sampling::Cloud &cloud) const;
    /// The tets of the points, which are cleared; points that lie outside are dropped. False if a facet is missing.
    bool triangulate(sampling::Cloud &cloud, sampling::RestrictedDelaunay &complex) const;

  private:
    const PinnedFacets &facets_;
    const domain::InputMesh &mesh_;
    std::size_t first_;
    double least_;
};

/// The new tets and those kept; `size` per point of the mesh.
Refilled merged(const sampling::Cloud &cloud, const sampling::RestrictedDelaunay &complex, const PinnedFacets &facets,
                const domain::InputMesh &mesh, std::span<const double> size);

/// What `fill` makes between the pinned facets: with squares, and without them where that gives nothing. Empty where
/// points share a place or all tets are kept.
Refilled fill_between(const domain::Reference &reference, const domain::InputMesh &mesh,
                      const std::vector<char> &pinned, std::span<const Edge> edges, Monitor &monitor,
                      const std::function<Refilled(const PinnedFacets &, const domain::RegionMap &)> &fill);

} // namespace wct::refill
