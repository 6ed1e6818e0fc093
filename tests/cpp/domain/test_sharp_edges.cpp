#include "domain/sharp_edges.h"

#include "base/random.h"
#include "support/bodies.h"
#include "support/closest.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace wct::tests {

namespace {

/// A prism of so many parts along z over the triangle between x and a line that rises by the angle from the origin.
/// With `around` the rest of what is near the z axis instead, so that outside is what is narrow there.
Body wedge(double degrees, int parts, bool around = false) {
    const double angle = degrees * std::numbers::pi / 180.0;
    std::vector<Vec3> rim;
    if (around)
        for (int k = 0; k <= 6; ++k) {
            const double turn = angle + k / 6.0 * (2.0 * std::numbers::pi - angle);
            rim.push_back({std::cos(turn), std::sin(turn), 0.0});
        }
    else
        rim = {{1.0, 0.0, 0.0}, {std::cos(angle), std::sin(angle), 0.0}};
    std::vector<Vec3> points;
    const int across = static_cast<int>(rim.size()) + 1;
    for (int k = 0; k <= parts; ++k) {
        const Vec3 up{0.0, 0.0, static_cast<double>(k)};
        points.push_back(up);
        for (const Vec3 &p : rim)
            points.push_back(p + up);
    }
    std::vector<Tet> tets;
    for (int k = 0; k < parts; ++k)
        for (int i = 1; i + 1 < across; ++i) {
            const int a = across * k, b = a + i, c = b + 1, up = across;
            tets.insert(tets.end(), {{a, b, c, c + up}, {a, b, c + up, b + up}, {a, b + up, c + up, a + up}});
        }
    for (Tet &t : tets)
        if (dot(points[t[1]] - points[t[0]], cross(points[t[2]] - points[t[0]], points[t[3]] - points[t[0]])) < 0.0)
            std::swap(t[2], t[3]);
    return stratified(std::move(points), tets, std::vector<int>(tets.size(), 0), facing);
}

} // namespace

TEST_CASE("Sharp edges: those of less than 60 degrees, as thick as their angle says") {
    for (const double angle : {8.0, 20.0, 40.0, 55.0}) {
        const domain::Reference reference(wedge(angle, 3).surface());
        const domain::SharpEdges sharp(reference);
        REQUIRE(sharp.count() == 3); // along the axis; the other edges of the prism are wider
        CHECK(domain::SharpEdges(reference, true).empty());
        for (int e = 0; e < 3; ++e) {
            // A chord at the distance 1 on both sides.
            CHECK(sharp.narrow(e) == doctest::Approx(2.0 * std::sin(angle * std::numbers::pi / 360.0)));
            for (const int v : sharp.ends(e))
                CHECK(std::hypot(reference.data().points[v].x, reference.data().points[v].y) == 0.0);
            const auto [one, other] = sharp.beside(e);
            CHECK(reference.data().patch[one] != reference.data().patch[other]);
        }
        int curves = 0;
        for (std::size_t c = 0; c < reference.curves().size(); ++c)
            curves += sharp.of_curve(static_cast<int>(c));
        CHECK(curves == 1);
    }
}

TEST_CASE("Sharp edges: none at 60 degrees and more, nor on a cube") {
    const domain::Reference wide(wedge(61.0, 2).surface()); // whose other two angles are of 59.5 degrees
    const domain::SharpEdges others(wide);
    CHECK(others.count() == 4);
    for (int e = 0; e < others.count(); ++e)
        for (const int v : others.ends(e))
            CHECK(std::hypot(wide.data().points[v].x, wide.data().points[v].y) == doctest::Approx(1.0));
    const domain::Reference box(cube(2, 0.1, 1).surface());
    CHECK(domain::SharpEdges(box).empty());
    CHECK(domain::SharpEdges(box, true).empty());
}

TEST_CASE("Sharp edges: a notch is sharp outside, not inside") {
    const domain::Reference reference(wedge(30.0, 2, true).surface());
    CHECK(domain::SharpEdges(reference).empty());
    const domain::SharpEdges notch(reference, true);
    REQUIRE(notch.count() == 2);
    CHECK(notch.narrow(0) == doctest::Approx(2.0 * std::sin(std::numbers::pi / 12.0)));
}

TEST_CASE("Sharp edges: where an interface ends, each angle between two facets counts by itself") {
    const double narrow = 2.0 * std::sin(20.0 * std::numbers::pi / 180.0);
    const domain::Reference notched(round_axis({{0.0, -1}, {40.0, 0}, {200.0, 1}}, 2).surface());
    const domain::Reference filled(round_axis({{0.0, 2}, {40.0, 0}, {200.0, 1}}, 2).surface());
    for (const bool outside : {true, false}) {
        const domain::Reference &reference = outside ? notched : filled;
        const domain::SharpEdges sharp(reference, outside);
        CHECK(domain::SharpEdges(reference, !outside).empty());
        REQUIRE(sharp.count() == 2);
        for (int e = 0; e < 2; ++e) {
            CHECK(sharp.narrow(e) == doctest::Approx(narrow));
            double turned = 0.0; // the sides look along 40 degrees and back along 0
            for (const int t : sharp.beside(e))
                turned += std::abs(std::atan2(std::abs(reference.normal(t).x), std::abs(reference.normal(t).y)));
            CHECK(turned == doctest::Approx(40.0 * std::numbers::pi / 180.0));
        }
        for (const auto &[degrees, inside] : {std::pair(0.0, true),
                                              {20.0, true},
                                              {40.0, true},
                                              {-10.0, false},
                                              {50.0, false},
                                              {120.0, false},
                                              {300.0, false}}) {
            const double turn = degrees * std::numbers::pi / 180.0;
            const Vec3 p{0.3 * std::cos(turn), 0.3 * std::sin(turn), 0.4};
            const domain::SharpFoot foot = sharp.nearest(p, 1.0);
            REQUIRE(foot.edge >= 0);
            CHECK(sharp.takes_in(foot, p) == inside);
        }
    }
}

TEST_CASE("Sharp edges: the nearest point, if it is near enough") {
    const domain::Reference reference(wedge(40.0, 4).surface());
    const domain::SharpEdges sharp(reference);
    Random random(2);
    for (int k = 0; k < 300; ++k) {
        const Vec3 p = random.normal3() + Vec3{0.0, 0.0, 2.0};
        const Vec3 foot{0.0, 0.0, std::clamp(p.z, 0.0, 4.0)};
        const double far = norm(p - foot);
        const domain::SharpFoot found = sharp.nearest(p, 1.01 * far);
        REQUIRE(found.edge >= 0);
        CHECK(found.distance == doctest::Approx(far));
        CHECK(norm(found.point - foot) < 1e-12);
        const auto &[a, b] = sharp.ends(found.edge);
        const Vec3 along = (1.0 - found.along) * reference.data().points[a] + found.along * reference.data().points[b];
        CHECK(norm(along - foot) < 1e-12);
        CHECK(sharp.nearest(p, 0.99 * far).edge == -1);
    }
}

} // namespace wct::tests
