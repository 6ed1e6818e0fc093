#include "geometry/crossing_triangles.h"

#include "geometry/predicates.h"

#include <algorithm>

namespace wct::geometry {

namespace {

bool apart(const std::array<Vec3, 3> &f, const std::array<Vec3, 3> &g, double Vec3::*axis) {
    const auto [low, high] = std::minmax({f[0].*axis, f[1].*axis, f[2].*axis});
    const auto [other_low, other_high] = std::minmax({g[0].*axis, g[1].*axis, g[2].*axis});
    return high < other_low || other_high < low;
}

bool pierces(const Vec3 &a, const Vec3 &b, const std::array<Vec3, 3> &g) {
    const auto &[p, q, r] = g;
    if (orient3d(p, q, r, a) * orient3d(p, q, r, b) >= 0)
        return false;
    const int side = orient3d(a, b, p, q);
    return side != 0 && orient3d(a, b, q, r) == side && orient3d(a, b, r, p) == side;
}

bool any_edge_pierces(const std::array<Vec3, 3> &f, const std::array<Vec3, 3> &g) {
    const auto in_both = [&](const Vec3 &p) { return std::find(g.begin(), g.end(), p) != g.end(); };
    for (int i = 0; i < 3; ++i) {
        const Vec3 &a = f[i], &b = f[(i + 1) % 3];
        if (!in_both(a) && !in_both(b) && pierces(a, b, g))
            return true;
    }
    return false;
}

} // namespace

bool triangles_cross(const std::array<Vec3, 3> &f, const std::array<Vec3, 3> &g) {
    if (apart(f, g, &Vec3::x) || apart(f, g, &Vec3::y) || apart(f, g, &Vec3::z))
        return false;
    return any_edge_pierces(f, g) || any_edge_pierces(g, f);
}

} // namespace wct::geometry
