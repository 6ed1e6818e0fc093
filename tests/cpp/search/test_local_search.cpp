#include "search/local_search.h"

#include "support/bench.h"
#include "support/remesh.h"
#include "support/state.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

namespace wct::tests {

namespace {

search::SearchOptions quick() {
    search::SearchOptions options;
    options.kicks = 400;
    return options;
}

/// A body made anew and searched: sound, on its surface, with the bad tets it says it has.
Searched remeshed(const Body &body, double tolerance) {
    const Start start = resampled(body, tolerance, 2);
    REQUIRE(start.intact);
    Searched made = searched(start, body, tolerance, quick());
    CHECK(fault(made.complex) == "");
    CHECK(pinch(made.complex) == "");
    CHECK(not_well_centered(made.complex, true) <= made.outcome.bad);
    CHECK(made.complex.over_count() <= made.outcome.bad);
    CHECK(made.outcome.bad <= static_cast<int>(start.bad));
    return made;
}

} // namespace

TEST_CASE("A cube comes out well-centered, whole and with its volume") {
    const Body body = cube(4, 0.2, 1);
    const Searched made = remeshed(body, 0.01);
    CHECK(made.outcome.bad == 0);
    CHECK(characteristics(made.complex) == std::vector<int>{1});
    CHECK(volumes(made.complex)[0] == doctest::Approx(1.0).epsilon(1e-12));
}

TEST_CASE("Two regions keep their volumes and the plane between them") {
    const Body body = cube(4, 0.2, 2, 0.5);
    const Searched made = remeshed(body, 0.01);
    CHECK(made.outcome.bad == 0);
    CHECK(characteristics(made.complex) == std::vector<int>{1, 1});
    for (const double volume : volumes(made.complex))
        CHECK(volume == doctest::Approx(0.5).epsilon(1e-12));
    for (const auto &[key, patch] : made.complex.sorted_surface())
        if (body.sides[patch][1] >= 0)
            for (const int v : key)
                CHECK(made.complex.point(v).x == 0.5);
}

TEST_CASE("A ball stays within the tolerance and keeps its volume") {
    const Body body = ball(4, 0.1, 3);
    const Searched made = remeshed(body, 0.04);
    CHECK(made.outcome.bad == 0);
    CHECK(characteristics(made.complex) == std::vector<int>{1});
    CHECK(volumes(made.complex)[0] == doctest::Approx(volumes(body)[0]).epsilon(0.02));
}

TEST_CASE("LocalSearch: the same start and seed give the same bits, another seed others") {
    const Body body = cube(3, 0.3, 4);
    search::SearchOptions options = quick();
    options.kicks = 60;
    const Searched first = searched(start_of(body), body, 0.02, options);
    const Searched second = searched(start_of(body), body, 0.02, options);
    CHECK(difference(State(first.complex), State(second.complex)) == "");
    CHECK(first.outcome.kicks == second.outcome.kicks);
    options.seed = 5;
    CHECK(difference(State(first.complex), State(searched(start_of(body), body, 0.02, options).complex)) != "");
}

TEST_CASE("LocalSearch: any number of threads gives the same bits, and says that the same was done") {
    long kicks = 0;
    for (const Body &body : {cube(6, 0.2, 4, 0.5), ball(5, 0.1, 3)}) {
        search::SearchOptions options = quick();
        options.volumes = volumes(complex_of(body));
        const Start start = resampled(body, 0.02, 2);
        const Searched alone = searched(start, body, 0.02, options);
        kicks += alone.outcome.kicks;
        for (const unsigned threads : {2u, 7u}) {
            options.workers = Workers(threads);
            const Searched together = searched(start, body, 0.02, options);
            CHECK(difference(State(alone.complex), State(together.complex)) == "");
            CHECK(together.outcome.stuck == alone.outcome.stuck);
            CHECK(together.outcome.kicks == alone.outcome.kicks);
            CHECK(together.outcome.accepted == alone.outcome.accepted);
            CHECK(together.outcome.evaluations == alone.outcome.evaluations);
            CHECK(together.outcome.work == alone.outcome.work);
        }
    }
    CHECK(kicks > 10);
}

TEST_CASE("LocalSearch: a fixed surface keeps every facet, and no more tets come than may") {
    const Body body = cube(3, 0.3, 5);
    search::SearchOptions options = quick();
    options.kicks = 100;
    options.flip_surface = options.split_surface = false;
    options.most = body.tets.size() + 5;
    std::vector<Facet> wanted, left;
    for (const Facet &f : body.facets)
        wanted.push_back(sorted(f[0], f[1], f[2]));
    std::sort(wanted.begin(), wanted.end());
    const Searched made = searched(pinned(body), body, 0.02, options);
    for (const auto &[key, patch] : made.complex.sorted_surface())
        left.push_back(key);
    CHECK(left == wanted);
    for (std::size_t v = 0; v < body.points.size(); ++v)
        if (body.stratum[v] != Stratum::interior)
            CHECK(made.complex.point(static_cast<int>(v)) == body.points[v]);
    CHECK(made.complex.tets() <= options.most);
    CHECK(fault(made.complex) == "");
}

TEST_CASE("LocalSearch: stopped at once it leaves a sound mesh, with no more bad tets than came in") {
    const Body body = cube(3, 0.3, 6);
    search::TetComplex complex = complex_of(body);
    const search::SurfaceGuide guide = guide_of(body, 0.02, 0.05);
    const int before = not_well_centered(complex, true);
    search::LocalSearch search(complex, guide, quick());
    int calls = 0;
    const search::SearchOutcome outcome = search.run([&](const char *, double, int) { return ++calls < 3; });
    CHECK(outcome.stopped);
    CHECK(fault(complex) == "");
    CHECK(not_well_centered(complex, true) <= before);
}

TEST_CASE("LocalSearch: the tets that stay bad share the kicks, an eighth of them in a hurry") {
    for (const int flat : {1, 2, 4}) {
        std::vector<Vec3> points;
        std::vector<Tet> tets;
        for (int k = 0; k < flat; ++k) {
            const int first = static_cast<int>(points.size());
            const Vec3 off{3.0 * k, 0.0, 0.0};
            for (const Vec3 &p : {Vec3{0.0, 0.0, 0.0}, Vec3{1.0, 0.0, 0.0}, Vec3{0.0, 1.0, 0.0}, Vec3{0.9, 0.9, 0.1}})
                points.push_back(p + off);
            tets.push_back({first, first + 1, first + 2, first + 3});
        }
        Body body = stratified(points, tets, std::vector<int>(tets.size(), 0),
                               [](const Vec3 &middle, const Vec3 &) { return static_cast<int>(middle.x); });
        body.size = 1.0;
        search::SearchOptions options = quick();
        options.kicks = 800;
        options.flip_surface = options.split_surface = false;
        for (const bool hurry : {false, true}) {
            options.hurry = hurry;
            search::TetComplex complex = complex_of(pinned(body).body);
            const search::SurfaceGuide guide = guide_of(body, 0.02, 0.125);
            const search::SearchOutcome outcome =
                search::LocalSearch(complex, guide, options).run([](const char *, double, int) { return true; });
            CHECK(outcome.bad == flat);
            CHECK(outcome.kicks == (hurry ? 100 : 800) / flat);
        }
    }
}

} // namespace wct::tests
