#include "geometry/protecting_balls.h"

#include "base/random.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace wct::tests {

namespace {

/// A facet, and points that rule out some of the balls through its corners.
struct Scene {
    std::array<Vec3, 3> corners;
    std::vector<Vec3> points;
    geometry::Sphere smallest;
    Vec3 n;
    double lo = -std::numeric_limits<double>::infinity(), hi = std::numeric_limits<double>::infinity();
};

/// The center of the corners' circle from two equations, of equal distances, and one for the plane, by Cramer's rule.
Vec3 circle_center(const std::array<Vec3, 3> &c, const Vec3 &n) {
    const Vec3 u = c[1] - c[0], v = c[2] - c[0];
    const double a = 0.5 * dot(u, u), b = 0.5 * dot(v, v), det = dot(u, cross(v, n));
    return c[0] + (1.0 / det) * (a * cross(v, n) + b * cross(n, u));
}

Scene scene(int points, Random &random) {
    Scene out;
    for (Vec3 &corner : out.corners)
        corner = random.normal3();
    out.n = unit(cross(out.corners[1] - out.corners[0], out.corners[2] - out.corners[0]));
    const Vec3 center = circle_center(out.corners, out.n);
    out.smallest = {center, norm(out.corners[0] - center)};
    for (int k = 0; k < points; ++k) {
        const Vec3 p = center + (2.0 * out.smallest.radius) * random.normal3(), d = p - center;
        const double power = dot(d, d) - out.smallest.radius * out.smallest.radius, side = dot(d, out.n);
        const double x = power / (2.0 * side); // the ball through p
        (side > 0.0 ? out.hi : out.lo) = side > 0.0 ? std::min(out.hi, x) : std::max(out.lo, x);
        out.points.push_back(p);
    }
    return out;
}

} // namespace

TEST_CASE("Protecting balls go through the corners and hold no point; where there is none, every ball holds one") {
    Random random(3);
    int found = 0, none = 0, smallest = 0;
    for (int k = 0; k < 2000; ++k) {
        const Scene s = scene(1 + random.below(8), random);
        const auto ball = geometry::protecting_ball(s.smallest, s.n, s.lo, s.hi);
        if (!ball) {
            ++none;
            CHECK(s.hi - s.lo <= 1e-6 * s.smallest.radius);
            continue;
        }
        ++found;
        for (const Vec3 &corner : s.corners)
            REQUIRE(norm(corner - ball->center) == doctest::Approx(ball->radius).epsilon(1e-9));
        for (const Vec3 &p : s.points)
            REQUIRE(norm(p - ball->center) > ball->radius);
        if (s.lo < -1e-3 && s.hi > 1e-3) { // the smallest of all will do
            ++smallest;
            CHECK(ball->radius == doctest::Approx(s.smallest.radius).epsilon(1e-9));
        }
    }
    CHECK(found > 500);
    CHECK(none > 30);
    CHECK(smallest > 100);
}

TEST_CASE("Protecting balls: what is inside, and the way out along a plane") {
    Random random(4);
    std::vector<geometry::Sphere> balls;
    for (int k = 0; k < 40; ++k)
        balls.push_back({random.normal3(), 0.1 + 0.4 * random.uniform()});
    const geometry::ProtectingBalls protecting(balls);
    const auto inside = [&](const Vec3 &p) {
        return std::any_of(balls.begin(), balls.end(),
                           [&](const auto &ball) { return norm(p - ball.center) < ball.radius; });
    };
    const auto onto = [](Vec3 &p) { p.z = 0.0; };
    int cleared = 0, held = 0;
    for (int k = 0; k < 1000; ++k) {
        Vec3 p = random.normal3();
        REQUIRE(protecting.contains(p) == inside(p));
        onto(p);
        const bool was = inside(p), out = protecting.clear(p, onto);
        CHECK(p.z == 0.0);
        if (out)
            CHECK_FALSE(inside(p));
        cleared += was && out;
        held += was && !out;
    }
    CHECK(cleared > 100);
    CHECK(held < cleared);
}

TEST_CASE(
    "Protecting balls: from the very middle no way out is the nearest, and of no balls there is nothing to leave") {
    const geometry::ProtectingBalls one({geometry::Sphere{{1.0, 2.0, 3.0}, 0.5}});
    const auto stay = [](Vec3 &) {};
    Vec3 p{1.0, 2.0, 3.0};
    CHECK_FALSE(one.clear(p, stay));
    CHECK(p == Vec3{1.0, 2.0, 3.0});
    p.x += 0.01;
    CHECK(one.clear(p, stay));
    CHECK(p.x == doctest::Approx(1.5).epsilon(1e-3));
    CHECK_FALSE(geometry::ProtectingBalls().contains(p));
    CHECK(geometry::ProtectingBalls().clear(p, stay));
}

} // namespace wct::tests
