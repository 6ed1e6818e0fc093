#pragma once

#include "base/cells.h"
#include "delaunay/delaunay.h"

#include <span>

namespace wct::delaunay {

/// Four points on a circle in one plane have two Delaunay triangulations: swap their diagonal, on both sides of the
/// plane, where `wanted` facets (ascending) are on the other one. Returns how many were swapped.
int swap_diagonals(Triangulation &all, std::span<const Vec3> points, std::span<const Facet> wanted);

} // namespace wct::delaunay
