#include "domain/reference.h"

#include "base/random.h"
#include "support/bodies.h"
#include "support/closest.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>

namespace wct::tests {

namespace {

double distance_to(const domain::SurfaceData &data, const Vec3 &p, int patch) {
    long double least = std::numeric_limits<long double>::infinity();
    for (std::size_t k = 0; k < data.triangles.size(); ++k)
        if (patch < 0 || data.patch[k] == patch) {
            const auto &[a, b, c] = data.triangles[k];
            least = std::min(least, square_to(p, std::array{data.points[a], data.points[b], data.points[c]}));
        }
    return static_cast<double>(std::sqrt(least));
}

} // namespace

TEST_CASE("Reference: nearest points of the surface and of a patch, whatever the hint") {
    const Body body = cylinder(4, 0.1, 1);
    const domain::Reference reference(body.surface());
    Random random(1);
    for (int k = 0; k < 300; ++k) {
        const Vec3 p = random.normal3();
        for (int patch = -1; patch < reference.patches(); ++patch) {
            const domain::Foot foot = reference.nearest(p, patch);
            REQUIRE(foot.distance == doctest::Approx(distance_to(reference.data(), p, patch)).epsilon(1e-12));
            REQUIRE(norm(p - foot.point) == doctest::Approx(foot.distance));
            REQUIRE((patch < 0 || reference.data().patch[foot.triangle] == patch));
            Vec3 blended;
            for (int i = 0; i < 3; ++i)
                blended += foot.weight[i] * reference.data().points[reference.data().triangles[foot.triangle][i]];
            REQUIRE(norm(blended - foot.point) < 1e-12);
            if (patch < 0) {
                const int hint = random.below(static_cast<int>(body.facets.size()));
                REQUIRE(reference.nearest(p, -1, hint).triangle == foot.triangle);
            }
        }
    }
}

TEST_CASE("Reference: strata of a cylinder") {
    const Body body = cylinder(4, 0.1, 1);
    const domain::Reference reference(body.surface());
    REQUIRE(reference.patches() == 3);
    int planar = 0;
    for (int patch = 0; patch < 3; ++patch) {
        planar += reference.planar(patch);
        CHECK_FALSE(reference.sheet(patch));
    }
    CHECK(planar == 2);
    REQUIRE(reference.curves().size() == 2);
    for (int c = 0; c < 2; ++c) {
        const domain::Curve &curve = reference.curves()[c];
        CHECK(curve.closed);
        CHECK_FALSE(curve.straight);
        CHECK(curve.steps() == 16);
        CHECK(reference.patches_at_curve(c).size() == 2);
        CHECK_FALSE(reference.bare(c));
        std::set<int> seen(curve.vertices.begin(), curve.vertices.end());
        CHECK(seen.size() == 16);
    }
    // A regular cylinder of radius 1: curvatures 1 and 0.
    const domain::Reference regular(cylinder(8, 0.0, 1).surface());
    for (int w = 0; w < regular.wedges(); ++w) {
        const Vec3 &p = regular.data().points[regular.wedge_vertex(w)];
        if (p.z > 0.3 && p.z < 0.7) {
            CHECK(regular.curvature(w)[0] == doctest::Approx(1.0).epsilon(0.1));
            CHECK(regular.curvature(w)[1] == doctest::Approx(0.0).scale(1.0).epsilon(0.05));
        }
    }
}

TEST_CASE("Reference: sides, heights, normals and rays of a cube of two regions") {
    const Body body = cube(4, 0.2, 2, 0.5);
    const domain::Reference reference(body.surface());
    Random random(2);
    for (int k = 0; k < 300; ++k) {
        const Vec3 p{1.4 * random.uniform() - 0.2, 1.4 * random.uniform() - 0.2, 1.4 * random.uniform() - 0.2};
        const domain::Foot foot = reference.nearest(p);
        const bool out = p.x < 0 || p.x > 1 || p.y < 0 || p.y > 1 || p.z < 0 || p.z > 1;
        REQUIRE(reference.region_beside(p, foot) == (out ? -1 : p.x > 0.5));
        REQUIRE(std::abs(reference.height(p, foot)) <= foot.distance * (1.0 + 1e-9));
        if (out)
            REQUIRE(reference.height(p, foot) > 0.0);
        if (!out) {
            int triangle = -1;
            const double at = reference.ray(p, {1.0, 0.0, 0.0}, 0.0, std::numeric_limits<double>::infinity(), triangle);
            REQUIRE(at == doctest::Approx(p.x < 0.5 ? 0.5 - p.x : 1.0 - p.x));
            REQUIRE(std::abs(reference.normal(triangle).x) == doctest::Approx(1.0));
            const int hit = triangle;
            REQUIRE(reference.ray(p, {1.0, 0.0, 0.0}, 0.0, 1.001 * at, triangle) == at);
            REQUIRE(triangle == hit);
            reference.ray(p, {1.0, 0.0, 0.0}, 0.0, 0.999 * at, triangle);
            REQUIRE(triangle == -1);
        }
    }
    double area = 0.0;
    for (int t = 0; t < static_cast<int>(body.facets.size()); ++t)
        area += reference.area(t);
    CHECK(area == doctest::Approx(7.0));
}

TEST_CASE("Reference: points put on patches and curves") {
    domain::Reference reference(cylinder(6, 0.1, 3).surface());
    Random random(3);
    for (int k = 0; k < 200; ++k) {
        const Vec3 p = random.normal3();
        for (int patch = 0; patch < 3; ++patch) {
            Vec3 x = p;
            const Vec3 normal = reference.to_patch(x, reference.nearest(p, patch));
            CHECK(norm(normal) == doctest::Approx(1.0));
            CHECK(distance_to(reference.data(), x, patch) < 1e-12);
        }
        for (int curve = 0; curve < 2; ++curve) {
            Vec3 x = p;
            const Vec3 tangent = reference.to_curve(x, curve);
            CHECK(norm(tangent) == doctest::Approx(1.0));
            CHECK(std::abs(tangent.z) < 1e-12);
            CHECK(reference.nearest_on_curve(x, curve).distance < 1e-12);
        }
    }
}

} // namespace wct::tests
