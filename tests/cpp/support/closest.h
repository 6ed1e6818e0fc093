#pragma once

#include "base/vec3.h"

#include <algorithm>
#include <array>

namespace wct::tests {

// Closest points the plain way, in long double: what faster ways are compared with.

struct Wide3 {
    long double x, y, z;
};
inline Wide3 wide(const Vec3 &a, const Vec3 &b) { // b - a
    return {static_cast<long double>(b.x) - a.x, static_cast<long double>(b.y) - a.y,
            static_cast<long double>(b.z) - a.z};
}
inline long double inner(const Wide3 &a, const Wide3 &b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Wide3 outer(const Wide3 &a, const Wide3 &b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Squared distance of p to the segment ab.
inline long double square_to(const Vec3 &p, const std::array<Vec3, 2> &segment) {
    const Wide3 u = wide(segment[0], segment[1]), d = wide(segment[0], p);
    const long double length = inner(u, u);
    const long double t = length > 0 ? std::clamp(inner(d, u) / length, 0.0L, 1.0L) : 0.0L;
    const Wide3 off{d.x - t * u.x, d.y - t * u.y, d.z - t * u.z};
    return inner(off, off);
}

/// The same to a triangle: to its plane if p lies over it, else to its sides.
inline long double square_to(const Vec3 &p, const std::array<Vec3, 3> &triangle) {
    const auto &[a, b, c] = triangle;
    const Wide3 u = wide(a, b), v = wide(a, c), d = wide(a, p), n = outer(u, v);
    const long double nn = inner(n, n);
    long double least =
        std::min({square_to(p, std::array{a, b}), square_to(p, std::array{b, c}), square_to(p, std::array{c, a})});
    if (nn > 0) {
        const long double second = inner(outer(d, v), n) / nn, third = inner(outer(u, d), n) / nn;
        if (second >= 0 && third >= 0 && second + third <= 1)
            least = std::min(least, inner(d, n) * inner(d, n) / nn);
    }
    return least;
}

} // namespace wct::tests
