#pragma once

#include "base/cells.h"
#include "base/parallel.h"
#include "base/vec3.h"
#include "geometry/triangle_tree.h"

#include <span>

namespace wct::geometry {

/// A sample and its distance to the other surface.
struct Farthest {
    double distance = 0.0;
    Vec3 at;
};

/// The sample of these triangles that is farthest from a surface: their corners, and regularly inside and on the edges
/// so that neighbours are at most `step` apart.
Farthest farthest_sample(std::span<const Vec3> points, std::span<const Facet> triangles, double step,
                         const TriangleTree &surface, const Workers &workers);

} // namespace wct::geometry
