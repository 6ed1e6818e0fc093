#pragma once

#include "cells.h"
#include "cloud.h"
#include "monitor.h"
#include "pinned_facets.h"
#include "region_map.h"
#include "restricted.h"

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace wct {

/// A mesh between pinned facets.
struct Interior {
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
    Keeper(const PinnedFacets &facets, const InputMesh &mesh, double least)
        : facets_(facets), mesh_(mesh), first_(facets.points().size()), least_(least) {}

    void clear(Cloud &cloud) const;
    /// The tets of the points, which are cleared; points that lie outside are dropped. False if a facet is missing.
    bool triangulate(Cloud &cloud, Complex &complex) const;

  private:
    const PinnedFacets &facets_;
    const InputMesh &mesh_;
    std::size_t first_;
    double least_;
};

/// The new tets and those kept; `size` per point of the mesh.
Interior merged(const Cloud &cloud, const Complex &complex, const PinnedFacets &facets, const InputMesh &mesh,
                std::span<const double> size);

/// What `fill` makes between the pinned facets: with squares, and without them where that gives nothing. Empty where
/// points share a place or all tets are kept.
Interior fill_between(const Reference &reference, const InputMesh &mesh, const std::vector<char> &pinned,
                      std::span<const Edge> edges, Monitor &monitor,
                      const std::function<Interior(const PinnedFacets &, const RegionMap &)> &fill);

} // namespace wct
