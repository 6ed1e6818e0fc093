#include "geometry/piece_tree.h"

#include "geometry/box_tree.h"

namespace wct::geometry {

Vec3 closest_on(const std::array<Vec3, 2> &segment, const Vec3 &x) {
    return nearest_on_segment(x, segment[0], segment[1]).point;
}

/// By the Voronoi regions of corners, edges and interior (Ericson, "Real-Time Collision Detection", 5.1.5).
Vec3 closest_on(const std::array<Vec3, 3> &triangle, const Vec3 &x) {
    const auto &[a, b, c] = triangle;
    const Vec3 ab = b - a;
    const Vec3 ac = c - a;
    const double d1 = dot(ab, x - a);
    const double d2 = dot(ac, x - a);
    if (d1 <= 0.0 && d2 <= 0.0)
        return a;
    const double d3 = dot(ab, x - b);
    const double d4 = dot(ac, x - b);
    if (d3 >= 0.0 && d4 <= d3)
        return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0)
        return a + (d1 / (d1 - d3)) * ab;
    const double d5 = dot(ab, x - c);
    const double d6 = dot(ac, x - c);
    if (d6 >= 0.0 && d5 <= d6)
        return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0)
        return a + (d2 / (d2 - d6)) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 >= d3 && d5 >= d6)
        return b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b);
    const double scale = 1.0 / (va + vb + vc);
    return a + (vb * scale) * ab + (vc * scale) * ac;
}

} // namespace wct::geometry
