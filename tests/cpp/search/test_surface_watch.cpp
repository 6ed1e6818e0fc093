#include "search/surface_watch.h"

#include "base/random.h"
#include "support/bench.h"
#include "support/closest.h"
#include "support/state.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace wct::tests {

namespace {

constexpr double kTolerance = 0.02;

/// A round cake with a slice of 20 degrees out of it, all of its surface one patch: the two sides of the slit meet in
/// vertices 0 (below) and 1. On the rim 2 + 2 k is below and 3 + 2 k above, from 10 degrees on to 350.
Body slit_cake() {
    constexpr int wedges = 10;
    std::vector<Vec3> points{{0, 0, 0}, {0, 0, 1}};
    for (int k = 0; k <= wedges; ++k) {
        const double turn = (10.0 + 34.0 * k) * std::numbers::pi / 180.0;
        points.push_back({std::cos(turn), std::sin(turn), 0.0});
        points.push_back({std::cos(turn), std::sin(turn), 1.0});
    }
    std::vector<Tet> tets;
    for (int k = 0; k < wedges; ++k) {
        const int low = 2 + 2 * k, high = low + 1, next = low + 2, above = low + 3;
        tets.insert(tets.end(), {{0, low, next, 1}, {low, next, 1, above}, {low, 1, high, above}});
    }
    for (Tet &t : tets)
        if (dot(points[t[1]] - points[t[0]], cross(points[t[2]] - points[t[0]], points[t[3]] - points[t[0]])) < 0.0)
            std::swap(t[2], t[3]);
    Body body = stratified(std::move(points), tets, std::vector<int>(tets.size(), 0),
                           [](const Vec3 &, const Vec3 &) { return 0; });
    body.size = 1.0;
    return body;
}

} // namespace

TEST_CASE("SurfaceWatch: at the beginning every landmark is with the nearest facet, and none is beyond the tolerance") {
    Bench bench(ball(4, 0.2, 3), kTolerance);
    CHECK(bench.complex.over_count() == 0);
    std::size_t owned = 0;
    for (const auto &[key, patch] : bench.complex.sorted_surface()) {
        for (int l = bench.complex.facet(key).landmark; l >= 0; l = bench.complex.next_landmark(l)) {
            ++owned;
            const Vec3 &point = bench.guide.landmarks()[l].point;
            const auto here = square_to(point, bench.complex.corners(key));
            for (const auto &[other, of] : bench.complex.sorted_surface())
                REQUIRE(square_to(point, bench.complex.corners(other)) >= here - 1e-15L);
        }
    }
    CHECK(owned == bench.guide.landmarks().size());
    CHECK(owned >= 90); // vertices of the surface, at least
}

TEST_CASE("SurfaceWatch: a mesh of other facets than the surface's is beyond the tolerance where it is") {
    const Body fine = ball(5, 0.0, 1), coarse = ball(2, 0.0, 1);
    const search::SurfaceGuide guide = guide_of(fine, kTolerance, 0.1);
    search::TetComplex complex = complex_of(coarse);
    search::SurfaceWatch watch(complex, guide);
    watch.begin();
    CHECK(complex.over_count() == static_cast<int>(coarse.facets.size())); // they sag by far more
    for (const auto &[key, patch] : complex.sorted_surface()) {
        const auto corners = complex.corners(key);
        const Vec3 middle = (1.0 / 3.0) * (corners[0] + corners[1] + corners[2]);
        CHECK(complex.over(key) > (1.0 - norm(middle)) / kTolerance - 2.0);
    }
}

TEST_CASE("SurfaceWatch: an angle between two creases at a corner stays divided, if that is asked for") {
    Bench bench(cube(2, 0.0, 1));
    const auto swap_allowed = [&](const Facet &one, const Facet &two, const Facet &first, const Facet &second,
                                  int patch) {
        bench.watch.clear();
        bench.watch.goes(one);
        bench.watch.goes(two);
        bench.watch.comes(first, patch);
        bench.watch.comes(second, patch);
        return bench.watch.allows_replacing();
    };
    const auto surface = bench.complex.sorted_surface();
    int divided = 0, filled = 0;
    for (const auto &[one, patch] : surface)
        for (const auto &[two, other] : surface) {
            std::vector<int> shared, apart;
            for (const int v : one)
                (std::count(two.begin(), two.end(), v) > 0 ? shared : apart).push_back(v);
            for (const int v : two)
                if (std::count(one.begin(), one.end(), v) == 0)
                    apart.push_back(v);
            if (patch != other || shared.size() != 2)
                continue;
            const Facet first = sorted(shared[0], apart[0], apart[1]), second = sorted(shared[1], apart[0], apart[1]);
            const auto corner = std::find_if(shared.begin(), shared.end(), [&](int v) {
                return bench.complex.vertex(v).stratum == Stratum::corner && bench.complex.is_crease(v, apart[0]) &&
                       bench.complex.is_crease(v, apart[1]);
            });
            if (corner == shared.end())
                continue;
            ++divided;
            bench.watch.divides_corners = false;
            CHECK(swap_allowed(one, two, first, second, patch));
            bench.watch.divides_corners = true;
            CHECK_FALSE(swap_allowed(one, two, first, second, patch));
        }
    for (const auto &[key, patch] : surface) { // one that fills an angle may go, or be replaced by another that does
        const auto is_corner = [&](int v) { return bench.complex.vertex(v).stratum == Stratum::corner; };
        if (std::none_of(key.begin(), key.end(), is_corner))
            continue;
        bench.watch.clear();
        bench.watch.goes(key);
        bench.watch.comes(key, patch);
        CHECK(bench.watch.allows_replacing());
        ++filled;
    }
    CHECK(divided >= 6); // twice as many facets as angles: a face of a cube of Kuhn's tets has two that are divided
    CHECK(filled >= 12);
}

TEST_CASE("SurfaceWatch: a vertex settles within the tolerance and nowhere else") {
    Bench bench(ball(4, 0.1, 5), kTolerance);
    Random random(1);
    int granted = 0, refused = 0;
    for (std::size_t k = 0; k < bench.body.points.size(); ++k) {
        const int v = static_cast<int>(k);
        const search::Vertex &vertex = bench.complex.vertex(v);
        if (vertex.stratum != Stratum::patch)
            continue;
        bench.watch.gather(v);
        CHECK(bench.watch.allows(vertex.position));
        CHECK_FALSE(bench.watch.allows(1.06 * vertex.position)); // three tolerances off
        CHECK_FALSE(bench.watch.allows(0.94 * vertex.position));
        const State before(bench.complex);
        const Vec3 x = vertex.position + (1.5 * kTolerance) * random.normal3();
        bench.complex.mark();
        const bool is = bench.watch.settle(x);
        ++(is ? granted : refused);
        if (is) {
            bench.complex.move(v, x);
            for (const auto &[key, patch] : bench.complex.sorted_surface())
                for (int l = bench.complex.facet(key).landmark; l >= 0; l = bench.complex.next_landmark(l))
                    REQUIRE(square_to(bench.guide.landmarks()[l].point, bench.complex.corners(key)) <=
                            kTolerance * kTolerance);
        } else {
            CHECK(difference(before, State(bench.complex)) == "");
        }
        bench.complex.rollback();
        CHECK(difference(before, State(bench.complex)) == "");
    }
    CHECK(granted > 10);
    CHECK(refused > 10);
}

TEST_CASE("SurfaceWatch: the cost's gradient is that of its differences") {
    Bench bench(ball(3, 0.1, 5), kTolerance);
    Random random(2);
    int tried = 0;
    for (std::size_t k = 0; k < bench.body.points.size(); ++k) {
        const int v = static_cast<int>(k);
        if (bench.complex.vertex(v).stratum != Stratum::patch)
            continue;
        bench.watch.loose = 10.0;
        bench.watch.gather(v);
        const Vec3 x = (1.0 + 2.5 * kTolerance) * bench.complex.point(v);
        Vec3 gradient;
        if (!bench.watch.allows(x))
            continue;
        const double here = bench.watch.cost(&gradient);
        CHECK(here > 1.0);
        const Vec3 to = 1e-7 * random.normal3();
        if (!bench.watch.allows(x + to))
            continue;
        const double there = bench.watch.cost(nullptr);
        if (std::abs(there - here) > 0.5)
            continue; // another facet came over
        CHECK(there - here == doctest::Approx(dot(gradient, to)).epsilon(1e-3).scale(1e-6));
        ++tried;
    }
    bench.watch.loose = 0.0;
    CHECK(tried > 10);
}

TEST_CASE("SurfaceWatch: near facets beyond the tolerance, none gets through the other side of a slit") {
    Bench bench(slit_cake(), 0.1);
    REQUIRE(fault(bench.complex) == "");
    bench.watch.loose = 100.0; // what a kick may leave on the way
    const int v = 2;           // on the rim below, at 10 degrees; across the slit is 22, at 350
    const double turn = -20.0 * std::numbers::pi / 180.0;
    const Vec3 through{std::cos(turn), std::sin(turn), 0.0}, before{1.0, 0.0, 0.0};
    bench.watch.gather(v);
    CHECK(bench.watch.allows(before));
    CHECK_FALSE(bench.watch.allows(through));
    bench.complex.mark();
    CHECK_FALSE(bench.watch.settle(through));
    bench.complex.rollback();
    // All tets there would be positive: nothing else would refuse it.
    bench.complex.move(v, through);
    CHECK(fault(bench.complex) == "");
    // Where it has got through, it may go back.
    bench.watch.gather(v);
    CHECK(bench.watch.allows(before));
}

TEST_CASE("SurfaceWatch: the surface does not come to bend as creases do") {
    Bench bench(ball(4, 0.0, 1), 0.3);
    int v = 0;
    while (bench.complex.vertex(v).stratum != Stratum::patch || std::abs(bench.complex.point(v).z) < 0.9)
        ++v;
    const Vec3 x = 0.85 * bench.complex.point(v); // a dent, well within the tolerance
    bench.watch.gather(v);
    CHECK(bench.watch.allows(x));
    bench.watch.crease = std::cos(40.0 * std::numbers::pi / 180.0);
    bench.watch.gather(v);
    CHECK_FALSE(bench.watch.allows(0.7 * bench.complex.point(v)));
    CHECK(bench.watch.allows(bench.complex.point(v)));
}

} // namespace wct::tests
