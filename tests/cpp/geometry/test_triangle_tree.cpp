#include "geometry/triangle_tree.h"

#include "base/random.h"
#include "geometry/farthest_sample.h"
#include "support/bodies.h"
#include "support/closest.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

namespace wct::tests {

namespace {

double distance_to(const Body &body, const Vec3 &p) {
    long double least = std::numeric_limits<long double>::infinity();
    for (const auto &[a, b, c] : body.facets)
        least = std::min(least, square_to(p, std::array{body.points[a], body.points[b], body.points[c]}));
    return static_cast<double>(std::sqrt(least));
}

} // namespace

TEST_CASE("TriangleTree: the nearest point of all triangles, whatever the hint") {
    const Body body = ball(4, 0.2, 1);
    const geometry::TriangleTree tree(body.points, body.facets);
    Random random(2);
    for (int k = 0; k < 400; ++k) {
        const Vec3 p = k % 4 ? random.normal3() : body.points[random.below(static_cast<int>(body.points.size()))];
        const auto found = tree.nearest(p);
        REQUIRE(std::sqrt(found.square) == doctest::Approx(distance_to(body, p)).epsilon(1e-12));
        const auto &[a, b, c] = body.facets[found.triangle];
        REQUIRE(square_to(found.point, std::array{body.points[a], body.points[b], body.points[c]}) < 1e-28L);
        const int hint = random.below(static_cast<int>(body.facets.size()));
        const auto hinted = tree.nearest(p, hint);
        REQUIRE(hinted.triangle == found.triangle);
        REQUIRE(hinted.point == found.point);
        const double enough = 2.0 * found.square + 1e-3;
        REQUIRE(tree.nearest(p, hint, enough).square <= enough);
    }
}

TEST_CASE("farthest_sample: no corner or point inside is farther from the other surface") {
    const Body coarse = ball(2, 0.0, 1), fine = ball(5, 0.2, 1);
    const geometry::TriangleTree tree(fine.points, fine.facets);
    constexpr double step = 0.05;
    const auto found = geometry::farthest_sample(coarse.points, coarse.facets, step, tree, Workers(2));
    CHECK(found.distance == doctest::Approx(distance_to(fine, found.at)));
    double most = 0.0;
    Random random(3);
    for (const auto &[a, b, c] : coarse.facets)
        for (int k = 0; k < 60; ++k) {
            double u = random.uniform(), v = random.uniform();
            if (u + v > 1.0)
                u = 1.0 - u, v = 1.0 - v;
            const Vec3 &p = coarse.points[a];
            most = std::max(most, distance_to(fine, p + u * (coarse.points[b] - p) + v * (coarse.points[c] - p)));
        }
    CHECK(found.distance <= most + step);
    CHECK(found.distance >= most - step); // distances change no faster than places
}

} // namespace wct::tests
