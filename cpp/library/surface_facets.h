#pragma once

#include "base/cells.h"

#include <array>
#include <span>
#include <vector>

namespace wct::library {

/// Facets with the outside or another region on one side: the boundary, outward, in the order of the tets; then the
/// interfaces, out of the region with the smaller index.
struct SurfaceFacets {
    std::vector<Facet> triangles;
    std::vector<std::array<int, 2>> sides; // the region behind and the one before, -1: outside
};

/// std::invalid_argument where a facet belongs to more than two tets, or two tets lie on the same side of one.
SurfaceFacets surface_of(std::span<const Tet> tets, std::span<const int> region);

} // namespace wct::library
