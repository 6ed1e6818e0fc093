#pragma once

#include "base/vec3.h"

#include <array>

namespace wct::geometry {

/// Smallest of the six angles between the facets of a positive tet, in radians.
double smallest_dihedral(const std::array<Vec3, 4> &tet);

} // namespace wct::geometry
