#pragma once

#include <array>
#include <cmath>

namespace wct {

/// A point or vector of space.
struct Vec3 {
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;

    Vec3 &operator+=(const Vec3 &o) {
        x += o.x;
        y += o.y;
        z += o.z;
        return *this;
    }
    Vec3 &operator-=(const Vec3 &o) {
        x -= o.x;
        y -= o.y;
        z -= o.z;
        return *this;
    }
    bool operator==(const Vec3 &) const = default;
};

inline double square(double x) {
    return x * x;
}
inline Vec3 operator+(const Vec3 &a, const Vec3 &b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3 operator-(const Vec3 &a, const Vec3 &b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Vec3 operator*(double s, const Vec3 &a) {
    return {s * a.x, s * a.y, s * a.z};
}
inline double dot(const Vec3 &a, const Vec3 &b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline double norm(const Vec3 &a) {
    return std::sqrt(dot(a, a));
}
inline Vec3 cross(const Vec3 &a, const Vec3 &b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vec3 unit(const Vec3 &v) {
    const double length = norm(v);
    return length > 0.0 ? (1.0 / length) * v : Vec3{};
}
/// In radians between two vectors, accurate near 0 and half a turn.
inline double angle(const Vec3 &a, const Vec3 &b) {
    return std::atan2(norm(cross(a, b)), dot(a, b));
}
/// Across a triangle, towards where it winds counterclockwise; twice its area long.
inline Vec3 normal_of(const std::array<Vec3, 3> &corners) {
    return cross(corners[1] - corners[0], corners[2] - corners[0]);
}
/// Of a tet; positive if its last corner is where the first three are seen to wind clockwise.
inline double six_volumes(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) {
    return dot(cross(b - a, c - a), d - a);
}

} // namespace wct
