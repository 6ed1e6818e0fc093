#pragma once

#include "base/cells.h"

#include <span>
#include <vector>

namespace wct::geometry {

/// Euler characteristic of each region: vertices - edges + facets - tets; regions count from 0, others are left out.
/// For a solid with manifold boundary it is half the boundary's: pieces - handles + cavities.
std::vector<int> euler_characteristics(std::span<const Tet> tets, std::span<const int> region);

} // namespace wct::geometry
