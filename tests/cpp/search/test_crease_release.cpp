#include "search/crease_release.h"

#include "support/bench.h"
#include "support/remesh.h"
#include "support/state.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace wct::tests {

namespace {

constexpr double kTolerance = 0.02;

search::SearchOptions little() {
    search::SearchOptions options;
    options.kicks = 40;
    return options;
}

} // namespace

TEST_CASE("CreaseRelease: a crease that holds tets up becomes ordinary surface, and they come right") {
    const Body body = cut_ball(4, 0.2, 3);
    REQUIRE(body.sides.size() == 2);
    REQUIRE_FALSE(body.creases.empty());
    const Searched stiff = searched(start_of(body), body, kTolerance, little());
    const int left = stiff.outcome.bad;
    CHECK(stiff.released.empty());
    REQUIRE(left > 0);

    const auto &[complex, outcome, released] = searched(start_of(body), body, kTolerance, little(), true);
    REQUIRE_FALSE(released.empty());
    CHECK(outcome.bad < left);
    CHECK(not_well_centered(complex, true) <= outcome.bad);
    CHECK(fault(complex) == "");
    CHECK(characteristics(complex) == std::vector<int>{1});
    const std::set<int> gone(released.begin(), released.end());
    for (const auto &[edge, curve] : complex.creases())
        CHECK_FALSE(gone.contains(curve));
    for (const auto &[key, patch] : complex.sorted_surface())
        CHECK(patch == 0); // the smallest number of those joined
    for (std::size_t k = 0; k < complex.vertex_slots(); ++k) {
        const search::Vertex &v = complex.vertex(static_cast<int>(k));
        if (complex.used(static_cast<int>(k)) && v.stratum == Stratum::crease)
            CHECK_FALSE(gone.contains(v.label));
        if (complex.used(static_cast<int>(k)) && v.stratum == Stratum::patch)
            CHECK(v.label == 0);
    }
    // What was held before is within the tolerance still: the true surface is that of the facets as they were.
    const search::SurfaceGuide guide = guide_of(ball(4, 0.2, 3), kTolerance, 0.125 * body.size);
    for (const auto &[key, patch] : complex.sorted_surface()) {
        search::SurfaceHints hints{};
        CHECK(guide.gap(0, complex.corners(key), hints).distance <= kTolerance * (1.0 + 1e-9));
    }
}

TEST_CASE("CreaseRelease: straight creases of planes stay, whatever is said of them") {
    const Body body = cube(3, 0.3, 8);
    search::SearchOptions options = little();
    options.passes = 1;
    options.kicks = 2; // so that some stay bad
    const auto &[complex, outcome, released] = searched(start_of(body), body, kTolerance, options, true);
    CHECK(released.empty());
    CHECK(fault(complex) == "");
    std::set<int> patches;
    for (const auto &[key, patch] : complex.sorted_surface())
        patches.insert(patch);
    CHECK(patches.size() == 6);
}

TEST_CASE("CreaseRelease: what stays keeps its number, and its vertices know it") {
    Body round = cylinder(4, 0.2, 3);
    const double size = round.size;
    // The round side is cut across, along edges; the crease there may go, the rims may not.
    Body body = stratified(round.points, round.tets, round.regions, [](const Vec3 &middle, const Vec3 &normal) {
        return std::abs(normal.z) < 0.5 ? (middle.z > 0.53 ? 0 : 1) : normal.z < 0.0 ? 2 : 3;
    });
    body.size = size;
    const auto on_rim = [&](int v) { return body.points[v].z == 0.0 || body.points[v].z == 1.0; };
    std::vector<std::uint8_t> loose(body.creases.size(), 0); // as many curves at most
    std::set<int> rims;
    for (std::size_t e = 0; e < body.creases.size(); ++e)
        if (on_rim(body.creases[e][0]) && on_rim(body.creases[e][1]))
            rims.insert(body.curve[e]);
        else
            loose[body.curve[e]] = 1;
    REQUIRE(rims.size() == 2);
    search::TetComplex complex = complex_of(body);
    search::CreaseRelease search(complex,
                                 {body.points, body.facets, body.patch, body.creases, body.curve, loose, 0.0, {}},
                                 kTolerance, 0.125 * size);
    search.run(little(), [](const char *, double, int) { return true; });
    REQUIRE_FALSE(search.released().empty());
    CHECK(fault(complex) == "");
    std::set<int> left, patches;
    for (const auto &[edge, curve] : complex.creases()) {
        left.insert(curve);
        for (const int v : edge)
            if (complex.vertex(v).stratum == Stratum::crease)
                CHECK(complex.vertex(v).label == curve);
    }
    CHECK(left == rims);
    for (const auto &[key, patch] : complex.sorted_surface()) {
        patches.insert(patch);
        for (const int v : key)
            if (complex.vertex(v).stratum == Stratum::patch)
                CHECK(complex.vertex(v).label == patch);
    }
    CHECK(patches.size() == 3);
}

TEST_CASE("CreaseRelease: only creases near what is stuck go, in meshes of any size") {
    for (const double scale : {1.0, 1.0 / 1024.0}) {
        CAPTURE(scale);
        const Body stuck = cut_ball(4, 0.2, 3);
        std::vector<Vec3> points = stuck.points;
        std::vector<Tet> tets = stuck.tets;
        // A regular tet beside it, which nothing holds up.
        const int first = static_cast<int>(points.size());
        const Vec3 beside{2.5, 0.0, 0.0};
        constexpr double side = 0.15;
        for (const Vec3 &p : {Vec3{1.0, 1.0, 1.0}, Vec3{1.0, -1.0, -1.0}, Vec3{-1.0, 1.0, -1.0}, Vec3{-1.0, -1.0, 1.0}})
            points.push_back(beside + side * p);
        tets.push_back({first, first + 2, first + 1, first + 3});
        const std::size_t count = tets.size();
        Body body = stratified(points, tets, std::vector<int>(count, 0), [](const Vec3 &middle, const Vec3 &normal) {
            return middle.x > 1.5 ? (normal.z > 0.0 ? 2 : 3) : middle.z > 0.03 ? 0 : 1;
        });
        body.size = scale * stuck.size;
        for (Vec3 &p : body.points)
            p = scale * p;
        std::set<int> far;
        for (std::size_t e = 0; e < body.creases.size(); ++e)
            if (body.creases[e][0] >= first)
                far.insert(body.curve[e]);
        REQUIRE_FALSE(far.empty());
        const Searched made = searched(start_of(body), body, scale * kTolerance, little(), true);
        CHECK_FALSE(made.released.empty());
        for (const int curve : made.released)
            CHECK_FALSE(far.contains(curve));
        CHECK(fault(made.complex) == "");
    }
}

TEST_CASE("CreaseRelease: a corner where all creases went is one no more, others stay") {
    Body made = ball(4, 0.2, 5);
    // Three slices of a ball: three creases from one corner to the other.
    Body body = stratified(made.points, made.tets, made.regions, [](const Vec3 &middle, const Vec3 &) {
        return static_cast<int>(std::floor(std::atan2(middle.y, middle.x) / 2.0943951023931953 + 10.0));
    });
    body.size = made.size;
    std::map<int, std::set<int>> curves_at;
    for (std::size_t e = 0; e < body.creases.size(); ++e)
        for (const int v : body.creases[e])
            curves_at[v].insert(body.curve[e]);
    REQUIRE(body.corners.size() == 2);
    int freed = 0, held = 0;
    for (const bool all : {true, false}) {
        search::TetComplex complex = complex_of(body);
        std::vector<std::uint8_t> loose(body.creases.size(), all); // as many curves at most
        loose[0] = 1;
        search::CreaseRelease search(complex,
                                     {body.points, body.facets, body.patch, body.creases, body.curve, loose, 0.0, {}},
                                     kTolerance, 0.125 * body.size);
        search.run(little(), [](const char *, double, int) { return true; });
        const std::set<int> gone(search.released().begin(), search.released().end());
        REQUIRE_FALSE(gone.empty());
        for (const int v : body.corners) { // corners keep their numbers: none is taken away
            const bool free = std::includes(gone.begin(), gone.end(), curves_at[v].begin(), curves_at[v].end());
            CHECK((complex.vertex(v).stratum == Stratum::corner) == !free);
            ++(free ? freed : held);
        }
        CHECK(fault(complex) == "");
    }
    CHECK(freed == 2);
    CHECK(held == 2);
}

} // namespace wct::tests
