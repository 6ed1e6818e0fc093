#pragma once

#include "base/vec3.h"

#include <array>

namespace wct::geometry {

/// Exact: does an edge of one triangle run through the inside of the other? Edges with an end in a corner of the other
/// do not count, nor does a touch.
bool triangles_cross(const std::array<Vec3, 3> &f, const std::array<Vec3, 3> &g);

} // namespace wct::geometry
