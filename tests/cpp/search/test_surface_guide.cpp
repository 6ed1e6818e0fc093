#include "search/surface_guide.h"

#include "base/random.h"
#include "geometry/kept_extent.h"
#include "support/bench.h"
#include "support/closest.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

namespace wct::tests {

namespace {

constexpr double kTolerance = 0.02;

double distance_to_patch(const Body &body, int patch, const Vec3 &p) {
    long double least = std::numeric_limits<long double>::infinity();
    for (std::size_t k = 0; k < body.facets.size(); ++k)
        if (body.patch[k] == patch) {
            const auto &[a, b, c] = body.facets[k];
            least = std::min(least, square_to(p, std::array{body.points[a], body.points[b], body.points[c]}));
        }
    return static_cast<double>(std::sqrt(least));
}

double distance_to_curve(const Body &body, int curve, const Vec3 &p) {
    long double least = std::numeric_limits<long double>::infinity();
    for (std::size_t k = 0; k < body.creases.size(); ++k)
        if (body.curve[k] == curve)
            least = std::min(
                least, square_to(p, std::array{body.points[body.creases[k][0]], body.points[body.creases[k][1]]}));
    return static_cast<double>(std::sqrt(least));
}

search::Vertex vertex_of(const Body &body, int v) {
    return {body.points[v], body.stratum[v], body.label[v], body.size, 0.9};
}

} // namespace

TEST_CASE("kept_extent: tolerances where these are small, a share of the whole where they are generous") {
    CHECK(geometry::kept_extent(100.0, 0.01) == doctest::Approx(0.28));
    CHECK(geometry::kept_extent(100.0, 1.0) == doctest::Approx(3.0));
    CHECK(geometry::kept_extent(1.0, 0.0) == 0.0);
}

TEST_CASE("SurfaceGuide: planes and lines of a cube are kept exactly, corners stay") {
    const Body body = cube(3, 0.2, 1);
    const search::SurfaceGuide guide = guide_of(body, kTolerance, 0.1);
    REQUIRE(guide.patches() == 6);
    Random random(1);
    for (std::size_t k = 0; k < body.points.size(); ++k) {
        const search::Vertex vertex = vertex_of(body, static_cast<int>(k));
        const Vec3 asked = body.points[k] + 0.1 * random.normal3();
        Vec3 x = asked;
        CHECK(guide.moves(vertex) == (vertex.stratum != Stratum::corner));
        if (!guide.moves(vertex))
            continue;
        std::int32_t hint = 0;
        const search::Freedom freedom = guide.admit(vertex, x, hint);
        if (vertex.stratum == Stratum::interior)
            CHECK(x == asked);
        if (vertex.stratum == Stratum::patch) {
            CHECK(guide.planar(vertex.label));
            int same = 0; // two coordinates as asked, the third exactly the plane's
            for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z})
                same += x.*axis == asked.*axis;
            CHECK(same == 2);
            CHECK((x.x == 0 || x.x == 1 || x.y == 0 || x.y == 1 || x.z == 0 || x.z == 1));
            const Vec3 left = freedom.of({1.0, 1.0, 1.0});
            CHECK(norm(left) == doctest::Approx(std::sqrt(2.0)));
        }
        if (vertex.stratum == Stratum::crease) {
            CHECK(guide.straight(vertex.label));
            CHECK(guide.exact(vertex.label));
            CHECK(norm(freedom.of({1.0, 1.0, 1.0})) == doctest::Approx(1.0));
            CHECK(norm(cross(x - body.points[k], freedom.axis)) < 1e-15);
            CHECK(dot(x - asked, freedom.axis) == doctest::Approx(0.0).scale(1.0));
        }
    }
    double area = 0.0;
    for (std::size_t patch = 0; patch < guide.patches(); ++patch)
        area += guide.area(static_cast<int>(patch));
    CHECK(area == doctest::Approx(6.0));
    CHECK(guide.landmarks().empty()); // planes need none
}

TEST_CASE("SurfaceGuide: vertices of a curved patch stay in a shell, of its creases in a tube of the plane") {
    const Body body = cylinder(4, 0.1, 2);
    const search::SurfaceGuide guide = guide_of(body, kTolerance, 0.1);
    Random random(2);
    for (std::size_t k = 0; k < body.points.size(); ++k) {
        const search::Vertex vertex = vertex_of(body, static_cast<int>(k));
        for (const double far : {0.2 * kTolerance, 5.0 * kTolerance}) {
            const Vec3 asked = body.points[k] + far * random.normal3();
            Vec3 x = asked;
            guide.admit(vertex, x);
            if (vertex.stratum == Stratum::patch && !guide.planar(vertex.label)) {
                CHECK(distance_to_patch(body, vertex.label, x) <= kTolerance);
                if (distance_to_patch(body, vertex.label, asked) < 0.9 * kTolerance)
                    CHECK(x == asked);
            }
            if (vertex.stratum == Stratum::crease) {
                CHECK((x.z == 0.0 || x.z == 1.0)); // in its plane, exactly
                CHECK(distance_to_curve(body, vertex.label, x) <= kTolerance);
                CHECK_FALSE(guide.straight(vertex.label));
                CHECK_FALSE(guide.bare(vertex.label));
            }
        }
    }
}

TEST_CASE("SurfaceGuide: corners of curved patches stay in a ball of half the tolerance there") {
    const Body body = cut_ball(4, 0.1, 5); // each vertex of its crease may be a corner
    std::vector<double> local(body.points.size(), kTolerance);
    for (std::size_t v = 0; v < local.size(); v += 2)
        local[v] = 0.2 * kTolerance;
    const search::SurfaceGuide plain = guide_of(body, kTolerance, 0.1);
    const search::SurfaceGuide narrow({body.points, body.facets, body.patch, body.creases, body.curve, 0.0, local},
                                      kTolerance, 0.1);
    Random random(6);
    for (const Edge &edge : body.creases)
        for (const int v : edge) {
            search::Vertex corner;
            corner.stratum = Stratum::corner;
            corner.label = v;
            const Vec3 home = body.points[v];
            for (const search::SurfaceGuide *guide : {&plain, &narrow}) {
                const double reach = 0.5 * (guide == &plain ? kTolerance : local[static_cast<std::size_t>(v)]);
                Vec3 x = home + 3.0 * kTolerance * unit(random.normal3());
                guide->admit(corner, x);
                CHECK(norm(x - home) == doctest::Approx(reach).epsilon(1e-9));
                const Vec3 asked = home + 0.9 * reach * unit(random.normal3());
                x = asked;
                guide->admit(corner, x);
                CHECK(x == asked);
            }
        }
}

TEST_CASE(
    "SurfaceGuide: facets near their patch, how far others are, heights and normals, against distances all over") {
    const Body body = ball(4, 0.1, 3);
    const search::SurfaceGuide guide = guide_of(body, kTolerance, 0.1);
    Random random(3);
    int near = 0;
    for (int k = 0; k < 400; ++k) {
        std::array<Vec3, 3> corners;
        const Facet &f = body.facets[random.below(static_cast<int>(body.facets.size()))];
        for (int i = 0; i < 3; ++i)
            corners[i] = (1.0 + 2.0 * kTolerance * (2.0 * random.uniform() - 1.0)) * body.points[f[i]];
        double most = 0.0;
        for (int i = 0; i <= 12; ++i)
            for (int j = 0; i + j <= 12; ++j) {
                const double u = i / 12.0, v = j / 12.0;
                const Vec3 p = u * corners[0] + v * corners[1] + (1.0 - u - v) * corners[2];
                most = std::max(most, distance_to_patch(body, 0, p));
            }
        search::SurfaceHints hints{};
        const bool is = guide.near(0, corners, 7, hints);
        near += is;
        if (is)
            CHECK(most <= kTolerance);
        else
            CHECK(most >= 0.9 * kTolerance);
        const auto gap = guide.gap(0, corners, hints);
        CHECK(gap.distance <= most * (1.0 + 1e-9) + 1e-9);
        const Vec3 at = gap.weights.x * corners[0] + gap.weights.y * corners[1] + gap.weights.z * corners[2];
        CHECK(norm(gap.to_surface) == doctest::Approx(gap.distance));
        CHECK(distance_to_patch(body, 0, at) == doctest::Approx(gap.distance).epsilon(1e-9));
        const Vec3 x = (0.5 + random.uniform()) * unit(random.normal3());
        const double height = guide.height(0, x, 0);
        CHECK(std::abs(height) == doctest::Approx(distance_to_patch(body, 0, x)).epsilon(1e-9));
        if (std::abs(norm(x) - 1.0) > 0.1)
            CHECK((height > 0.0) == (norm(x) > 1.0)); // in front is outside
        CHECK(dot(guide.normal(0, x, 0), unit(x)) > 0.8);
        search::SurfaceHints unused{};
        CHECK(guide.offset(0, {1.05 * corners[0], 1.05 * corners[1], 1.05 * corners[2]}, unused) > 0.0);
    }
    CHECK(near > 30);
    CHECK(near < 350);
}

TEST_CASE(
    "SurfaceGuide: where the tolerance is less in places, facets and vertices keep the one of the nearest piece") {
    const Body body = ball(5, 0.1, 3);
    std::vector<double> local;
    for (const Vec3 &p : body.points)
        local.push_back(kTolerance * std::clamp(0.5 + 0.5 * p.z, 0.25, 1.0));
    const search::SurfaceGuide guide({body.points, body.facets, body.patch, body.creases, body.curve, 0.0, local},
                                     kTolerance, 0.1);
    // Of the nearest triangle: the greatest of equally near ones.
    const auto tolerance_at = [&](const Vec3 &p) {
        const double distance = distance_to_patch(body, 0, p);
        double greatest = 0.0;
        for (const auto &[a, b, c] : body.facets)
            if (std::sqrt(square_to(p, std::array{body.points[a], body.points[b], body.points[c]})) <= distance + 1e-12)
                greatest = std::max(greatest, std::min({local[a], local[b], local[c]}));
        return greatest;
    };
    Random random(4);
    int near = 0;
    for (int k = 0; k < 600; ++k) {
        const Facet &f = body.facets[random.below(static_cast<int>(body.facets.size()))];
        const double least = std::min({local[f[0]], local[f[1]], local[f[2]]});
        const double share = 2.0 * random.uniform(); // by which each corner may be off, in the least of the tolerances
        std::array<Vec3, 3> corners;
        for (int i = 0; i < 3; ++i)
            corners[i] = (1.0 + share * least * (2.0 * random.uniform() - 1.0)) * body.points[f[i]];
        search::SurfaceHints hints{};
        const bool is = guide.near(0, corners, 7, hints);
        near += is;
        if (share < 0.3)
            CHECK(is);
        const Vec3 middle = (1.0 / 3.0) * (corners[0] + corners[1] + corners[2]);
        if (is)
            CHECK(distance_to_patch(body, 0, middle) <= tolerance_at(middle));
        search::Vertex vertex;
        vertex.stratum = Stratum::patch;
        vertex.label = 0;
        for (Vec3 x : {corners[0], (1.0 + 3.0 * least * random.uniform()) * body.points[f[1]]}) {
            const Vec3 asked = x;
            guide.admit(vertex, x);
            CHECK(distance_to_patch(body, 0, x) <= tolerance_at(asked));
            if (distance_to_patch(body, 0, asked) < 0.2 * kTolerance)
                CHECK(x == asked);
        }
    }
    CHECK(near > 150);
    CHECK(near < 550);
}

TEST_CASE("SurfaceGuide: landmarks are the vertices and points between them, as close together as asked") {
    const Body body = ball(3, 0.1, 4);
    constexpr double spacing = 0.05;
    const search::SurfaceGuide guide = guide_of(body, kTolerance, spacing);
    std::size_t vertices = 0;
    for (std::size_t l = 0; l < guide.landmarks().size(); ++l) {
        const auto &landmark = guide.landmarks()[l];
        CHECK(distance_to_patch(body, landmark.patch, landmark.point) < 1e-12);
        if (landmark.joined)
            CHECK(norm(guide.landmarks()[l + 1].point - landmark.point) <= spacing * (1.0 + 1e-9));
        vertices += std::count(body.points.begin(), body.points.end(), landmark.point) > 0;
        CHECK(guide.strict(static_cast<int>(l)) == 1.0);
    }
    CHECK(vertices == static_cast<std::size_t>(std::count(body.stratum.begin(), body.stratum.end(), Stratum::patch)));
    const Vec3 point = guide.landmarks()[0].point, across{-point.y, point.x, 0.0};
    for (const double far : {0.9, 1.01}) {
        const Vec3 c = point + far * kTolerance * unit(point);
        const Vec3 second = cross(unit(point), unit(across));
        CHECK(guide.covers({c + unit(across), c - unit(across) + second, c - unit(across) - second}, 0) == (far < 1.0));
    }
}

TEST_CASE("SurfaceGuide: crease edges within the tolerance of their curve") {
    const Body body = cylinder(5, 0.0, 5);
    const search::SurfaceGuide guide = guide_of(body, kTolerance, 0.1);
    Random random(6);
    int allowed = 0;
    for (int k = 0; k < 300; ++k) {
        const auto at = [&] { return body.creases[random.below(static_cast<int>(body.creases.size()))][0]; };
        const int a = at(), b = at();
        const int curve = body.label[a];
        if (curve != body.label[b] || norm(body.points[a] - body.points[b]) > 0.8)
            continue;
        double most = 0.0;
        for (int i = 0; i <= 40; ++i)
            most = std::max(
                most, distance_to_curve(body, curve, (i / 40.0) * body.points[a] + (1.0 - i / 40.0) * body.points[b]));
        const bool is = guide.allows_crease(curve, body.points[a], body.points[b]);
        allowed += is;
        CHECK((is ? most <= kTolerance : most >= 0.9 * kTolerance));
    }
    CHECK(allowed > 5);
}

TEST_CASE("SurfaceGuide: a crease edge is near its curve or not from whichever end it is asked about") {
    const Body body = cylinder(5, 0.0, 5);
    const search::SurfaceGuide guide = guide_of(body, kTolerance, 0.1);
    Random random(7);
    int near = 0, far = 0;
    while (near < 300 || far < 300) {
        const auto at = [&] { return body.creases[random.below(static_cast<int>(body.creases.size()))][0]; };
        const int a = at(), b = at();
        if (body.label[a] != body.label[b] || norm(body.points[a] - body.points[b]) > 0.8)
            continue;
        const auto moved = [&](int v) { return body.points[v] + 0.4 * kTolerance * random.normal3(); };
        const Vec3 p = moved(a), q = moved(b);
        const bool is = guide.allows_crease(body.label[a], p, q);
        CHECK(guide.allows_crease(body.label[a], q, p) == is);
        ++(is ? near : far);
    }
}

TEST_CASE("SurfaceGuide: the rim of a plane that parts a curved side stands out less than that of an end") {
    const Body body = drum(8);
    const search::SurfaceGuide guide = guide_of(body, kTolerance, 0.05);
    double parting = 0.0, end = 0.0;
    for (std::size_t v = 0; v < body.points.size(); ++v) {
        if (body.stratum[v] != Stratum::crease)
            continue;
        search::Vertex vertex;
        vertex.position = body.points[v];
        vertex.stratum = Stratum::crease;
        vertex.label = body.label[v];
        const Vec3 home = body.points[v];
        Vec3 x = home + 3.0 * kTolerance * unit(Vec3{home.x, home.y, 0.0});
        guide.admit(vertex, x);
        double &farthest = std::abs(home.z - 0.5) < 0.25 ? parting : end;
        farthest = std::max(farthest, norm(x - home));
        CHECK(x.z == home.z);
    }
    CHECK(parting == doctest::Approx(0.7 * kTolerance).epsilon(0.01));
    CHECK(end == doctest::Approx(0.9 * kTolerance).epsilon(0.01));
}

} // namespace wct::tests
