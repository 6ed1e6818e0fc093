#include "geometry/closest_point.h"

#include <algorithm>

namespace wct::geometry {

namespace {

/// Find which of the seven Voronoi regions of triangle abc the point p lies in (Ericson, "Real-Time Collision
/// Detection", 5.1.5), and return what is made of it there: corner(i), along(i, j, share of the way from corner i to
/// j), or inside(weight of b, of c).
template <class Corner, class Along, class Inside>
inline auto by_region(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c, const Corner &corner,
                      const Along &along, const Inside &inside) {
    const Vec3 ab = b - a;
    const Vec3 ac = c - a;
    const Vec3 ap = p - a;
    const double d1 = dot(ab, ap);
    const double d2 = dot(ac, ap);
    if (d1 <= 0.0 && d2 <= 0.0)
        return corner(0);
    const Vec3 bp = p - b;
    const double d3 = dot(ab, bp);
    const double d4 = dot(ac, bp);
    if (d3 >= 0.0 && d4 <= d3)
        return corner(1);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0)
        return along(0, 1, d1 / (d1 - d3));
    const Vec3 cp = p - c;
    const double d5 = dot(ab, cp);
    const double d6 = dot(ac, cp);
    if (d6 >= 0.0 && d5 <= d6)
        return corner(2);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0)
        return along(0, 2, d2 / (d2 - d6));
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 >= d3 && d5 >= d6)
        return along(1, 2, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
    const double scale = 1.0 / (va + vb + vc);
    return inside(vb * scale, vc * scale);
}

} // namespace

SegmentPoint nearest_on_segment(const Vec3 &p, const Vec3 &a, const Vec3 &b) {
    const Vec3 d = b - a;
    const double length = dot(d, d);
    const double t = length > 0.0 ? std::clamp(dot(p - a, d) / length, 0.0, 1.0) : 0.0;
    const Vec3 q = a + t * d;
    return {q, t, dot(p - q, p - q)};
}

TrianglePoint nearest_on_triangle(const Vec3 &p, const Vec3 &a, const Vec3 &b, const Vec3 &c) {
    TrianglePoint out{{}, {0.0, 0.0, 0.0}, 0.0};
    auto &weight = out.weight;
    by_region(
        p, a, b, c, [&](int i) { weight[i] = 1.0; },
        [&](int i, int j, double share) {
            weight[i] = 1.0 - share;
            weight[j] = share;
        },
        [&](double v, double w) {
            weight[0] = 1.0 - v - w;
            weight[1] = v;
            weight[2] = w;
        });
    out.point = weight[0] * a + weight[1] * b + weight[2] * c;
    const Vec3 d = p - out.point;
    out.square = dot(d, d);
    return out;
}

Vec3 closest_on(const std::array<Vec3, 2> &segment, const Vec3 &x) {
    return nearest_on_segment(x, segment[0], segment[1]).point;
}

Vec3 closest_on(const std::array<Vec3, 3> &triangle, const Vec3 &x) {
    const auto &[a, b, c] = triangle;
    return by_region(
        x, a, b, c, [&](int i) { return triangle[i]; },
        [&](int i, int j, double share) { return triangle[i] + share * (triangle[j] - triangle[i]); },
        [&](double v, double w) { return a + v * (b - a) + w * (c - a); });
}

} // namespace wct::geometry
