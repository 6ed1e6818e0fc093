#pragma once

#include "base/vec3.h"

#include <array>
#include <cmath>

namespace wct::geometry {

struct Sphere {
    Vec3 center;
    double radius = 0.0;
};

/// From a corner of a tet, with edges u, v and w from there and u . v x w = det, to its circumcenter.
inline Vec3 to_circumcenter(const Vec3 &u, const Vec3 &v, const Vec3 &w, double det) {
    return (0.5 / det) * (dot(u, u) * cross(v, w) + dot(v, v) * cross(w, u) + dot(w, w) * cross(u, v));
}

/// From a corner of a triangle, with edges u and v from there and normal n = u x v, to its circumcenter.
inline Vec3 to_circumcenter(const Vec3 &u, const Vec3 &v, const Vec3 &n) {
    return (0.5 / dot(n, n)) * (dot(u, u) * cross(v, n) + dot(v, v) * cross(n, u));
}

/// Through the corners of a tet that is not flat.
inline Sphere circumsphere(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) {
    const Vec3 u = b - a, v = c - a, w = d - a;
    const Vec3 to = to_circumcenter(u, v, w, dot(u, cross(v, w)));
    return {a + to, norm(to)};
}

/// The smallest through the corners of a triangle: its center lies in the triangle's plane.
inline Sphere circumsphere(const std::array<Vec3, 3> &corners) {
    const Vec3 u = corners[1] - corners[0], v = corners[2] - corners[0];
    const Vec3 to = to_circumcenter(u, v, cross(u, v));
    return {corners[0] + to, norm(to)};
}

} // namespace wct::geometry
