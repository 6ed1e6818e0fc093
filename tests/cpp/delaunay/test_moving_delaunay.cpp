#include "delaunay/moving_delaunay.h"

#include "base/random.h"
#include "geometry/predicates.h"
#include "support/neighbours.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace wct::tests {

namespace {

using delaunay::Triangulation;

std::set<std::array<int, 4>> tets_of(const Triangulation &made) {
    std::set<std::array<int, 4>> out;
    for (std::array<int, 4> tet : made.tets) {
        std::sort(tet.begin(), tet.end());
        out.insert(tet);
    }
    return out;
}

/// The same tets as from scratch, and neighbours that share a facet.
void check(const Triangulation &made, const std::vector<Vec3> &points) {
    REQUIRE(tets_of(made) == tets_of(delaunay::delaunay(points)));
    REQUIRE(tets_of(made).size() == made.tets.size());
    for (std::size_t t = 0; t < made.tets.size(); ++t) {
        const auto &[a, b, c, d] = made.tets[t];
        REQUIRE(geometry::orient3d(points[a], points[b], points[c], points[d]) == 1);
    }
    check_neighbours(made);
}

/// A body-centered lattice in a box whose faces are full of points: planes, and spheres through more than four.
std::vector<Vec3> lattice(int n) {
    std::vector<Vec3> points;
    for (int k = 0; k <= n; ++k)
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i) {
                points.push_back({1.0 * i, 1.0 * j, 1.0 * k});
                if (i < n && j < n && k < n)
                    points.push_back({i + 0.5, j + 0.5, k + 0.5});
            }
    return points;
}

bool on_face(const Vec3 &p, int n) {
    return std::min({p.x, p.y, p.z}) == 0.0 || std::max({p.x, p.y, p.z}) == n;
}

} // namespace

TEST_CASE("MovingDelaunay: points that move a little, inside, on faces and at random, give the tets of a fresh start") {
    for (const double far : {0.0, 1e-3, 0.02, 0.06}) {
        CAPTURE(far);
        constexpr int n = 7;
        std::vector<Vec3> points = lattice(n);
        delaunay::MovingDelaunay moving;
        Random random(5);
        for (int step = 0; step < 8; ++step) {
            check(moving.of(points, Workers(3)), points);
            for (Vec3 &p : points) {
                if (random.uniform() > 0.1)
                    continue;
                const Vec3 by = far * random.normal3();
                const bool face = on_face(p, n);
                const auto along = [&](double x, double d) { return face && (x == 0.0 || x == n) ? x : x + d; };
                const Vec3 q{along(p.x, by.x), along(p.y, by.y), along(p.z, by.z)};
                if (face || !(on_face(q, n) || std::min({q.x, q.y, q.z}) < 0.0 || std::max({q.x, q.y, q.z}) > n))
                    p = q;
            }
        }
        CHECK(moving.made() <= 3);
    }
}

TEST_CASE("MovingDelaunay: the hull may bend and break, points may cross it and each other") {
    Random random(6);
    std::vector<Vec3> points;
    for (int k = 0; k < 400; ++k)
        points.push_back(k % 3 ? random.normal3() : unit(random.normal3()));
    delaunay::MovingDelaunay moving;
    for (int step = 0; step < 60; ++step) {
        check(moving.of(points), points);
        for (int k = 0; k < 6; ++k) {
            Vec3 &p = points[static_cast<std::size_t>(random.below(400))];
            p += 0.05 * random.normal3();
        }
    }
    CHECK(moving.made() < 10); // mended, most times
    for (Vec3 &p : points)
        p = random.normal3();
    const std::size_t before = moving.made();
    check(moving.of(points), points);
    CHECK(moving.made() == before + 1); // all is elsewhere
}

TEST_CASE("MovingDelaunay: where everything turns by a rounding, planes bend and tets of the hull come and go") {
    std::vector<Vec3> points = lattice(5);
    const std::vector<Vec3> straight = points;
    delaunay::MovingDelaunay moving;
    for (int step = 0; step < 10; ++step) {
        const double angle = 1e-3 * step, c = std::cos(angle), s = std::sin(angle);
        for (std::size_t k = 0; k < points.size(); ++k)
            points[k] = {c * straight[k].x - s * straight[k].y, s * straight[k].x + c * straight[k].y, straight[k].z};
        check(moving.of(points), points);
    }
}

TEST_CASE("MovingDelaunay: more points or fewer are a fresh start, and what cannot be is refused") {
    std::vector<Vec3> points = lattice(3);
    delaunay::MovingDelaunay moving;
    check(moving.of(points), points);
    points.push_back({0.3, 0.4, 0.45});
    check(moving.of(points), points);
    CHECK(moving.made() == 2);
    points[3] = points[4];
    CHECK_THROWS_WITH(moving.of(points), "delaunay: points 3 and 4 coincide");
    points[3].x = std::nan("");
    CHECK_THROWS_AS(moving.of(points), std::invalid_argument);
}

} // namespace wct::tests
