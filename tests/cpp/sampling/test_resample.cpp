#include "sampling/resample.h"

#include "geometry/euler_characteristic.h"
#include "sampling/surface_fit.h"
#include "sampling/tet_estimate.h"
#include "support/bench.h"
#include "support/closest.h"
#include "support/remesh.h"
#include "support/state.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

namespace wct::tests {

namespace {

/// A body with what seeds are made from.
struct Domain {
    Body body;
    domain::InputMesh mesh;
    domain::Reference reference;
    domain::RegionMap map;
    domain::Sizing sizing;

    Domain(Body made, double tolerance)
        : body(std::move(made)), mesh(body.mesh()), reference(body.surface()), map(mesh, reference),
          sizing(reference, mesh, map, form(tolerance), {}, Workers(2)) {}
    Domain(const Domain &) = delete;

    static domain::SizingForm form(double tolerance) {
        domain::SizingForm form;
        form.tolerance = tolerance;
        return form;
    }
    sampling::Cloud seeds(unsigned threads, std::uint64_t seed) const {
        Random random(seed);
        Monitor monitor({});
        return sampling::make_seeds(reference, map, sizing, {}, std::nullopt, nullptr, random, monitor,
                                    Workers(threads));
    }
};

} // namespace

TEST_CASE("Seeds stand where their role wants them, apart from each other, the same at any number of threads") {
    const Domain domain(cube(4, 0.1, 1, 0.5), 0.01);
    const sampling::Cloud cloud = domain.seeds(1, 3), again = domain.seeds(3, 3), others = domain.seeds(1, 4);
    CHECK(cloud.points == again.points);
    CHECK_FALSE(cloud.points == others.points);
    std::map<Stratum, int> count;
    for (std::size_t k = 0; k < cloud.count(); ++k) {
        const Vec3 &p = cloud.points[k];
        ++count[cloud.role[k]];
        const int label = cloud.label[k];
        switch (cloud.role[k]) {
        case Stratum::interior:
            CHECK(domain.map.region(p, domain.reference.nearest(p)) == label);
            CHECK(domain.reference.nearest(p).distance > 0.2 * cloud.size[k]);
            break;
        case Stratum::patch:
            CHECK(domain.reference.nearest(p, label).distance < 1e-12);
            break;
        case Stratum::crease:
            CHECK(domain.reference.nearest_on_curve(p, label).distance < 1e-12);
            break;
        case Stratum::corner:
            CHECK(p == domain.body.points[label]);
        }
        for (std::size_t j = 0; j < k; ++j)
            CHECK(norm(p - cloud.points[j]) > 0.25 * std::min(cloud.size[k], cloud.size[j]));
    }
    CHECK(count[Stratum::corner] == 12); // eight, and four at the plane between the regions
    CHECK(count[Stratum::crease] >= 20);
    CHECK(count[Stratum::patch] >= 50);
    CHECK(count[Stratum::interior] >= 10);
}

TEST_CASE("Restricted Delaunay: every tet is of the region that its middle is in") {
    const Domain domain(cube(4, 0.1, 1, 0.5), 0.01);
    const sampling::Cloud cloud = domain.seeds(1, 3);
    const auto complex = sampling::restricted_delaunay(cloud, domain.reference, domain.map, Workers(2));
    double sums[2] = {0.0, 0.0};
    for (std::size_t t = 0; t < complex.all.tets.size(); ++t) {
        if (complex.region[t] < 0)
            continue;
        const auto &[a, b, c, d] = complex.all.tets[t];
        const Vec3 &o = cloud.points[a];
        const Vec3 middle = 0.25 * (o + cloud.points[b] + cloud.points[c] + cloud.points[d]);
        sums[complex.region[t]] += dot(cloud.points[b] - o, cross(cloud.points[c] - o, cloud.points[d] - o)) / 6.0;
        if (std::abs(middle.x - 0.5) > 0.05)
            CHECK(complex.region[t] == (middle.x > 0.5));
    }
    CHECK(sums[0] + sums[1] == doctest::Approx(1.0).epsilon(1e-9));
    CHECK(sums[0] == doctest::Approx(0.5).epsilon(0.05));
}

TEST_CASE("Resample: a start is sound, in strata, near its surface, and the same at any number of threads") {
    const Body body = cylinder(5, 0.1, 2);
    constexpr double tolerance = 0.03;
    const Start start = resampled(body, tolerance, 1);
    REQUIRE(start.intact);
    CHECK(fault(complex_of(start.body)) == "");
    CHECK(pinch(complex_of(start.body)) == "");
    CHECK(characteristics(complex_of(start.body)) == std::vector<int>{1});
    CHECK(volumes(start.body)[0] == doctest::Approx(volumes(body)[0]).epsilon(0.02));
    const domain::Reference reference(body.surface());
    for (std::size_t k = 0; k < start.body.points.size(); ++k) {
        const Vec3 &p = start.body.points[k];
        const int label = start.body.label[k];
        if (start.body.stratum[k] == Stratum::patch)
            CHECK(reference.nearest(p, label).distance <= tolerance);
        if (start.body.stratum[k] == Stratum::crease)
            CHECK(reference.nearest_on_curve(p, label).distance <= tolerance);
    }
    const Start threaded = resampled(body, tolerance, 3);
    CHECK(threaded.body.points == start.body.points);
    CHECK(threaded.body.tets == start.body.tets);
    CHECK_FALSE(resampled(body, tolerance, 1, 2).body.points == start.body.points);
}

TEST_CASE("Seeds round the rim of an interface come right before anything moves") {
    const Domain domain(cube(8, 0.0, 1, 0.5), 0.01);
    const sampling::Cloud cloud = domain.seeds(2, 3);
    const auto complex = sampling::restricted_delaunay(cloud, domain.reference, domain.map, Workers(2));
    const auto on_rim = [&](int v) {
        const Vec3 &p = cloud.points[v];
        return p.x == 0.5 && (p.y == 0.0 || p.y == 1.0 || p.z == 0.0 || p.z == 1.0);
    };
    int tets = 0, bad = 0;
    for (std::size_t t = 0; t < complex.all.tets.size(); ++t) {
        const Tet &tet = complex.all.tets[t];
        if (complex.region[t] < 0 || std::none_of(tet.begin(), tet.end(), on_rim))
            continue;
        std::array<Vec3, 4> p;
        for (int i = 0; i < 4; ++i)
            p[i] = cloud.points[tet[i]];
        ++tets;
        bad += !well_centered(p, true);
    }
    CHECK(tets > 150);
    CHECK(bad == 0);
}

TEST_CASE("Resample: two regions meet in whole facets on their plane") {
    const Body body = cube(4, 0.2, 3, 0.25);
    const Start start = resampled(body, 0.01, 2);
    REQUIRE(start.intact);
    CHECK(fault(complex_of(start.body)) == "");
    CHECK(volumes(start.body)[0] == doctest::Approx(0.25).epsilon(1e-12));
    CHECK(volumes(start.body)[1] == doctest::Approx(0.75).epsilon(1e-12));
}

TEST_CASE("estimate_tets is about what a start has") {
    const Domain domain(ball(5, 0.1, 4), 0.05);
    const double expected = sampling::estimate_tets(domain.reference, domain.mesh, domain.sizing, Workers(2));
    CHECK(expected == sampling::estimate_tets(domain.reference, domain.mesh, domain.sizing, Workers(1)));
    const double made = static_cast<double>(resampled(domain.body, 0.05, 2).body.tets.size());
    CHECK(made / expected > 0.5);
    CHECK(made / expected < 2.0);
}

TEST_CASE("Surface fit: facets get within the limit of their ties where they were not") {
    const Domain domain(ball(6, 0.0, 5), 0.02);
    sampling::Cloud cloud = domain.seeds(1, 3);
    const auto complex = sampling::restricted_delaunay(cloud, domain.reference, domain.map, Workers(2));
    std::vector<Vec3> direction(cloud.count());
    for (std::size_t k = 0; k < cloud.count(); ++k)
        if (cloud.role[k] == Stratum::patch)
            direction[k] = unit(cloud.points[k]);
    const std::vector<sampling::Tie> ties = sampling::tie_surface(cloud, complex, domain.reference, Workers(2));
    REQUIRE(ties.size() > 500);
    const auto longest = [&] {
        double most = 0.0;
        for (const sampling::Tie &tie : ties) {
            Vec3 x;
            for (int i = 0; i < 3; ++i)
                x += tie.weight[i] * cloud.points[tie.corner[i]];
            most = std::max(most, std::abs(dot(tie.normal, x) - tie.level));
        }
        return most;
    };
    const double before = longest();
    const std::vector<Vec3> unfitted = cloud.points;
    const sampling::FitForm form{0.6 * before, 0.1, 0.02, before};
    CHECK(sampling::count_off(cloud, ties, form.limit) > 0);
    CHECK(sampling::count_off(cloud, ties, 1.001 * before) == 0);
    const std::size_t off = sampling::count_off(cloud, ties, form.limit);
    sampling::fit_heights(cloud, domain.reference, ties, direction, form, Workers(2));
    CHECK(sampling::count_off(cloud, ties, form.limit) < off);
    CHECK(longest() < before);
    for (std::size_t k = 0; k < cloud.count(); ++k) {
        const Vec3 moved = cloud.points[k] - unfitted[k];
        CHECK(norm(cross(moved, direction[k])) < 1e-12); // along the normal alone
        if (cloud.role[k] != Stratum::patch)
            CHECK(moved == Vec3{});
        else
            CHECK(domain.reference.nearest(cloud.points[k]).distance <= form.shell * (1.0 + 1e-9));
    }
}

TEST_CASE("euler_characteristics: of bodies, a ring and two in one region") {
    const Body body = cube(3, 0.0, 1, 1.0 / 3.0);
    CHECK(geometry::euler_characteristics(body.tets, body.regions) == std::vector<int>{1, 1});
    Body ring = cube(3, 0.0, 1); // without the column in the middle
    std::vector<std::array<int, 4>> left;
    for (const Tet &tet : ring.tets) {
        Vec3 middle;
        for (const int v : tet)
            middle += 0.25 * ring.points[v];
        if (std::abs(middle.x - 0.5) > 1.0 / 6.0 || std::abs(middle.y - 0.5) > 1.0 / 6.0)
            left.push_back(tet);
    }
    CHECK(geometry::euler_characteristics(left, std::vector<int>(left.size(), 0)) == std::vector<int>{0});
    std::vector<int> both;
    for (const Tet &tet : ring.tets) { // outer columns
        double x = 0.0;
        for (const int v : tet)
            x += 0.25 * ring.points[v].x;
        both.push_back(std::abs(x - 0.5) > 1.0 / 6.0 ? 0 : -1);
    }
    CHECK(geometry::euler_characteristics(ring.tets, both) == std::vector<int>{2});
}

TEST_CASE("Resample: narrow angles where interfaces end are represented, and rows stand beside them") {
    for (const int between : {-1, 2}) { // outside, or a third region
        CAPTURE(between);
        std::size_t bad = 0;
        for (const std::uint64_t seed : {1, 2}) {
            const Start start = resampled(round_axis({{10.0, between}, {36.0, 0}, {200.0, 1}}, 7), 0.005, 1, seed);
            CHECK(start.intact);
            bad += start.bad;
        }
        if (between < 0)
            CHECK(bad < 1400); // without rows 2200: sizes go to nothing there
    }
}

} // namespace wct::tests
