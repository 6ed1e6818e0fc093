#include "geometry/crossing_triangles.h"

#include "base/random.h"

#include <doctest/doctest.h>

namespace wct::tests {

namespace {

using Triangle = std::array<Vec3, 3>;

/// Where the segment from a to b meets the triangle's plane, in weights of the corners; by Cramer's rule.
bool meets(const Vec3 &a, const Vec3 &b, const Triangle &t, double slack) {
    const Vec3 u = t[1] - t[0], v = t[2] - t[0], d = a - b, r = a - t[0];
    const double det = dot(u, cross(v, d));
    const double second = dot(r, cross(v, d)) / det, third = dot(u, cross(r, d)) / det, at = dot(u, cross(v, r)) / det;
    return second > slack && third > slack && second + third < 1.0 - slack && at > slack && at < 1.0 - slack;
}

bool cross_somewhere(const Triangle &f, const Triangle &g, double slack) {
    for (int i = 0; i < 3; ++i)
        if (meets(f[i], f[(i + 1) % 3], g, slack) || meets(g[i], g[(i + 1) % 3], f, slack))
            return true;
    return false;
}

} // namespace

TEST_CASE("triangles_cross agrees with where edges meet planes") {
    Random random(1);
    int crossing = 0;
    for (int k = 0; k < 20000; ++k) {
        Triangle f, g;
        for (int i = 0; i < 3; ++i) {
            f[i] = random.normal3();
            g[i] = random.normal3();
        }
        const bool surely = cross_somewhere(f, g, 1e-9), maybe = cross_somewhere(f, g, -1e-9);
        const bool is = geometry::triangles_cross(f, g);
        REQUIRE((surely == maybe ? is == surely : true));
        REQUIRE(geometry::triangles_cross(g, f) == is);
        crossing += is;
    }
    CHECK(crossing > 2000);
}

TEST_CASE("Neighbours in a surface do not cross, and touching is no crossing") {
    const Vec3 o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    CHECK_FALSE(geometry::triangles_cross({o, x, y}, {o, y, z}));
    CHECK_FALSE(geometry::triangles_cross({o, x, y}, {o, x, y}));
    CHECK_FALSE(geometry::triangles_cross({o, x, y}, {o, {-1, 0, 0}, z}));
    CHECK_FALSE(geometry::triangles_cross({o, x, y}, {Vec3{0.2, 0.2, 0}, Vec3{0.2, 0.2, 1}, Vec3{0.3, 0.2, 1}}));
    CHECK_FALSE(geometry::triangles_cross({o, x, y}, {Vec3{0.5, 0, -1}, Vec3{0.5, 0, 1}, Vec3{0.5, -1, 0}}));
    // With a corner in common they do where the side opposite to it runs through the other.
    CHECK(geometry::triangles_cross({o, x, y}, {o, Vec3{0.3, 0.3, -1}, Vec3{0.3, 0.3, 1}}));
    CHECK(geometry::triangles_cross({o, x, y}, {Vec3{0.2, 0.2, -1e-300}, Vec3{0.2, 0.2, 1e-300}, z}));
    CHECK(geometry::triangles_cross({o, x, y}, {Vec3{0.5, 0.5, -1}, Vec3{0.4, 0.4, 1}, Vec3{0.4, 0.4, 2}}));
}

} // namespace wct::tests
