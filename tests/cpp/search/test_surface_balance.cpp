#include "search/surface_balance.h"

#include "support/bench.h"
#include "support/remesh.h"
#include "support/state.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace wct::tests {

namespace {

/// Mean signed distance of the facets from the unit sphere, weighted by area.
double mean_height(const search::TetComplex &complex) {
    double sum = 0.0, area = 0.0;
    for (const auto &[key, patch] : complex.sorted_surface()) {
        const auto corners = complex.corners(key);
        const double here = norm(normal_of(corners));
        for (const Vec3 &w : {Vec3{0.6, 0.2, 0.2}, Vec3{0.2, 0.6, 0.2}, Vec3{0.2, 0.2, 0.6}}) {
            const Vec3 p = w.x * corners[0] + w.y * corners[1] + w.z * corners[2];
            sum += here * (norm(p) - 1.0) / 3.0;
        }
        area += here;
    }
    return sum / area;
}

double area_of(const search::TetComplex &complex, int patch) {
    double sum = 0.0;
    for (const auto &[key, own] : complex.sorted_surface())
        if (own == patch)
            sum += 0.5 * norm(normal_of(complex.corners(key)));
    return sum;
}

int bad_in(const Bench &bench) {
    int bad = 0;
    for (std::size_t t = 0; t < bench.complex.tet_slots(); ++t)
        bad += bench.complex.alive(static_cast<int>(t)) && bench.energy.bad(bench.complex.energy(static_cast<int>(t)));
    return bad;
}

} // namespace

TEST_CASE("SurfaceBalance: a coarse mesh on the sphere moves out until it has the volume asked for") {
    constexpr double tolerance = 0.06;
    const Start start = resampled(ball(6, 0.0, 1), tolerance, 2);
    REQUIRE(start.intact);
    Bench bench(start.body, tolerance);
    const int bad = bad_in(bench), over = bench.complex.over_count();
    const double asked = 1.01 * volumes(bench.complex)[0];
    search::SurfaceBalance(bench.complex, bench.energy, bench.guide, bench.descent, std::vector<double>{asked}).run();
    CHECK(volumes(bench.complex)[0] == doctest::Approx(asked).epsilon(2e-4));
    CHECK(bad_in(bench) <= bad);
    CHECK(bench.complex.over_count() <= over);
    CHECK(fault(bench.complex) == "");
}

TEST_CASE("SurfaceBalance: by force a volume is met, whatever tets that makes bad, within the tolerance") {
    constexpr double tolerance = 0.06, more = 1.02, borne = 4.5e-3;
    const Start start = resampled(ball(4, 0.0, 1), tolerance, 2);
    REQUIRE(start.intact);
    Bench bench(start.body, tolerance);
    const double before = volumes(bench.complex)[0];
    const int over = bench.complex.over_count();
    const std::vector<double> asked{more * before};
    search::SurfaceBalance balance(bench.complex, bench.energy, bench.guide, bench.descent, asked);
    const std::vector<char> patches = balance.kept_patches();
    CHECK(std::count(patches.begin(), patches.end(), 1) == 0); // no plane with a curved rim, no patch inside
    CHECK(balance.missed(patches) == doctest::Approx(1.0 - 1.0 / more - borne));
    balance.force(patches);
    CHECK(balance.missed(patches) == 0.0);
    CHECK(std::abs(volumes(bench.complex)[0] - asked[0]) <= borne * asked[0]);
    CHECK(bench.complex.over_count() <= over);
    CHECK(fault(bench.complex) == "");
}

TEST_CASE("SurfaceBalance: where no volume is asked for, facets lie as much before the surface as behind it") {
    constexpr double tolerance = 0.05;
    const Body fine = ball(8, 0.0, 1);
    Body coarse = ball(4, 0.0, 1); // its facets hang inside
    Bench bench(coarse, tolerance);
    const search::SurfaceGuide guide = guide_of(fine, tolerance, 0.05);
    search::SurfaceWatch watch(bench.complex, guide);
    watch.begin();
    search::VertexDescent descent(bench.complex, bench.energy, guide, watch);
    const double before = mean_height(bench.complex);
    REQUIRE(before < -0.2 * tolerance);
    search::SurfaceBalance(bench.complex, bench.energy, guide, descent, {}).run();
    CHECK(std::abs(mean_height(bench.complex)) < 0.25 * std::abs(before));
    CHECK(fault(bench.complex) == "");
}

TEST_CASE("SurfaceBalance: flat ends of a cylinder get their area, and stay flat") {
    constexpr double tolerance = 0.05;
    const Body fine = cylinder(10, 0.0, 1);
    const Body coarse = cylinder(4, 0.0, 1);
    REQUIRE(fine.sides.size() == coarse.sides.size());
    Bench bench(coarse, tolerance);
    const search::SurfaceGuide guide = guide_of(fine, tolerance, 0.05);
    search::SurfaceWatch watch(bench.complex, guide);
    watch.begin();
    search::VertexDescent descent(bench.complex, bench.energy, guide, watch);
    int planes = 0;
    std::vector<double> missed;
    for (int patch = 0; patch < 3; ++patch)
        missed.push_back(guide.planar(patch) ? guide.area(patch) - area_of(bench.complex, patch) : 0.0);
    search::SurfaceBalance(bench.complex, bench.energy, guide, descent, {}).run();
    for (int patch = 0; patch < 3; ++patch) {
        if (!guide.planar(patch))
            continue;
        ++planes;
        CHECK(missed[static_cast<std::size_t>(patch)] > 0.0); // chords cut it
        CHECK(std::abs(guide.area(patch) - area_of(bench.complex, patch)) <
              0.3 * missed[static_cast<std::size_t>(patch)]);
        double lo = 1e9, hi = -1e9;
        for (const auto &[key, own] : bench.complex.sorted_surface())
            if (own == patch)
                for (const Vec3 &p : bench.complex.corners(key)) {
                    lo = std::min(lo, p.z);
                    hi = std::max(hi, p.z);
                }
        CHECK(lo == hi);
    }
    CHECK(planes == 2);
    CHECK(fault(bench.complex) == "");
}

TEST_CASE("SurfaceBalance: areas that are far off are kept roughly where the mesh beside makes room") {
    constexpr double tolerance = 0.05;
    const Body fine = cylinder(10, 0.0, 1);
    Bench bench(cylinder(4, 0.0, 1), tolerance);
    const search::SurfaceGuide guide = guide_of(fine, tolerance, 0.05);
    search::SurfaceWatch watch(bench.complex, guide);
    watch.begin();
    search::VertexDescent descent(bench.complex, bench.energy, guide, watch);
    const int bad = bad_in(bench);
    std::vector<double> missed;
    for (int patch = 0; patch < 3; ++patch)
        missed.push_back(guide.area(patch) - area_of(bench.complex, patch));
    search::SurfaceBalance(bench.complex, bench.energy, guide, descent, {}).keep_areas_roughly();
    for (int patch = 0; patch < 3; ++patch)
        if (guide.planar(patch)) {
            CHECK(missed[static_cast<std::size_t>(patch)] > 0.01 * guide.area(patch));
            CHECK(std::abs(guide.area(patch) - area_of(bench.complex, patch)) <
                  0.3 * missed[static_cast<std::size_t>(patch)]);
        }
    CHECK(bad_in(bench) <= bad);
    CHECK(fault(bench.complex) == "");
}

TEST_CASE("SurfaceBalance: a vertex alone on its curved patch has no neighbours to be evened with") {
    Body whole = ball(2, 0.0, 1);
    const auto top = [](const Vec3 &middle, const Vec3 &) { return middle.z > 0.75 ? 0 : 1; };
    Body body = stratified(whole.points, whole.tets, whole.regions, top);
    body.size = whole.size;
    Bench bench(body, 0.05);
    std::vector<int> alone;
    for (std::size_t k = 0; k < body.points.size(); ++k)
        if (body.points[k].z > 0.75 && body.stratum[k] == Stratum::patch)
            alone.push_back(static_cast<int>(k));
    REQUIRE(alone.size() == 1);
    REQUIRE_FALSE(bench.guide.planar(body.label[static_cast<std::size_t>(alone[0])]));
    search::SurfaceBalance(bench.complex, bench.energy, bench.guide, bench.descent, {}).run();
    CHECK(norm(bench.complex.point(alone[0]) - body.points[static_cast<std::size_t>(alone[0])]) <= 0.05);
    CHECK(fault(bench.complex) == "");
}

} // namespace wct::tests
