#pragma once

#include "base/vec3.h"

#include <array>
#include <cmath>

namespace wct::geometry {

/// The point of a triangle nearest to p, with its barycentric coordinates.
struct TrianglePoint {
    Vec3 point;
    double weight[3];
    double square; // squared distance to p
};
/// The same of a segment from a to b.
struct SegmentPoint {
    Vec3 point;
    double along; // 0 at a, 1 at b
    double square;
};
SegmentPoint nearest_on_segment(const Vec3 &p, const Vec3 &a, const Vec3 &b);
TrianglePoint nearest_on_triangle(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c);

/// Closest point on a segment (two corners) or triangle (three).
Vec3 closest_on(const std::array<Vec3, 2> &segment, const Vec3 &x);
Vec3 closest_on(const std::array<Vec3, 3> &triangle, const Vec3 &x);

/// What tells where a point lies over a triangle: the weights of the second and third corner at its projection are dot
/// products. Not numbers where the triangle is flat.
struct TriangleFrame {
    Vec3 second, third, normal;

    explicit TriangleFrame(const std::array<Vec3, 3> &c) {
        const Vec3 ab = c[1] - c[0], ac = c[2] - c[0], n = cross(ab, ac);
        const double scale = 1.0 / dot(n, n);
        second = scale * cross(ac, n);
        third = scale * cross(n, ab);
        normal = std::sqrt(scale) * n;
    }
};
/// The same with the triangle's frame at hand. Mostly a point lies over the inside of the triangle that it is near;
/// this is cheap to see.
inline Vec3 closest_on(const std::array<Vec3, 3> &triangle, const TriangleFrame &frame, const Vec3 &x) {
    constexpr double on_side = -1e-9; // of the height over a side: a point over the side is over the triangle
    const Vec3 d = x - triangle[0];
    const double u = dot(d, frame.second), v = dot(d, frame.third);
    if (u >= on_side && v >= on_side && u + v <= 1.0 - on_side)
        return x - dot(d, frame.normal) * frame.normal;
    return closest_on(triangle, x);
}

} // namespace wct::geometry
