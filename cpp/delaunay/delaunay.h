#pragma once

#include "base/cells.h"
#include "base/vec3.h"

#include <array>
#include <span>
#include <vector>

namespace wct::delaunay {

/// Tets that fill the convex hull of some points.
struct Triangulation {
    std::vector<Tet> tets;                      // positive by orient3d
    std::vector<std::array<int, 4>> neighbours; // [i]: the tet across the facet opposite vertex i, -1 on the hull
};

/// The Delaunay tetrahedralization of all the points: no point lies inside the sphere of a tet, and no tet is flat,
/// both exactly. Where more than four points share a sphere, the choice among them depends on their coordinates alone,
/// not on their numbering. Throws std::invalid_argument for fewer than four points, for points that are not finite,
/// coincide or all lie in one plane, naming them; std::length_error beyond 2^29 tets.
Triangulation delaunay(std::span<const Vec3> points);

} // namespace wct::delaunay
