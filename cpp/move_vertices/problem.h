#pragma once

#include "base/cells.h"
#include "base/vec3.h"

#include <cstdint>
#include <vector>

namespace wct::move_vertices {

/// A mesh whose points are to move, and the boundary that they are to stay on: patch points on the triangles of the
/// patch they are labelled with, crease points on the segments of their curve, as these lie at the start.
struct Problem {
    std::vector<Vec3> points;
    std::vector<Tet> tets;
    std::vector<Stratum> stratum;
    std::vector<std::int64_t> label;
    std::vector<Facet> triangles;
    std::vector<std::int64_t> triangle_patch;
    std::vector<Edge> segments;
    std::vector<std::int64_t> segment_curve;
};

/// Point numbers in an order that keeps neighbours in space near each other in memory (along Morton's curve).
std::vector<std::int32_t> spatial_order(const std::vector<Vec3> &points);

/// The same problem with point order[i] as point i, and the tets in the order of their points.
Problem renumbered(const Problem &problem, const std::vector<std::int32_t> &order);

} // namespace wct::move_vertices
