#include "search/operators.h"

#include "support/bench.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace wct::tests {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 0.02;

} // namespace

TEST_CASE("Operators: no edge and no facet is made that is there already, where a mesh overlaps itself") {
    const auto body_of = [](std::vector<Vec3> points, std::vector<Tet> tets) {
        const std::size_t count = tets.size();
        Body body = stratified(std::move(points), std::move(tets), std::vector<int>(count, 0),
                               [](const Vec3 &, const Vec3 &) { return 0; });
        body.size = 1.0;
        return body;
    };
    const Vec3 low{0.0, 0.0, -1.0}, high{0.0, 0.0, 1.0};
    // Three tets round the edge 0-1, and one with the facet that would take the edge's place.
    const double x = 0.5, y = std::sqrt(0.75);
    const std::vector<Vec3> three{low, high, {1.0, 0.0, 0.0}, {-x, y, 0.0}, {-x, -y, 0.0}, {0.0, 0.0, 0.4}};
    const std::vector<Tet> round{{0, 1, 2, 3}, {0, 1, 3, 4}, {0, 1, 4, 2}};
    std::vector<Tet> more = round;
    more.push_back({2, 3, 4, 5});
    Bench free(body_of({three.begin(), three.begin() + 5}, round)), taken(body_of(three, more));
    CHECK(free.operators.remove_edge(0, 1, kInfinity));
    CHECK_FALSE(taken.operators.remove_edge(0, 1, kInfinity));
    // Four, and two others with the edges of which one would.
    const std::vector<Vec3> four{low,
                                 high,
                                 {1.0, 0.0, 0.0},
                                 {0.0, 1.0, 0.0},
                                 {-1.0, 0.0, 0.0},
                                 {0.0, -1.0, 0.0},
                                 {0.1, 0.2, 3.0},
                                 {0.3, -0.1, 4.0}};
    const std::vector<Tet> ring{{0, 1, 2, 3}, {0, 1, 3, 4}, {0, 1, 4, 5}, {0, 1, 5, 2}};
    const auto positive = [&](Tet tet) {
        if (six_volumes(four[tet[0]], four[tet[1]], four[tet[2]], four[tet[3]]) < 0.0)
            std::swap(tet[2], tet[3]);
        return tet;
    };
    Bench open(body_of({four.begin(), four.begin() + 6}, ring));
    more = ring;
    more.push_back(positive({2, 4, 6, 7}));
    more.push_back(positive({3, 5, 6, 7}));
    Bench closed(body_of(four, more));
    CHECK(open.operators.remove_edge(0, 1, kInfinity));
    CHECK_FALSE(closed.operators.remove_edge(0, 1, kInfinity));
    // A whole ring, and one more tet at the same edge.
    more = round;
    more.push_back({0, 1, 5, 6});
    std::vector<Vec3> beside(three.begin(), three.begin() + 5);
    beside.push_back({0.2, -0.1, 0.0});
    beside.push_back({0.1, 0.2, 0.0});
    Bench crowded(body_of(beside, more));
    search::Ring found;
    CHECK(free.operators.ring(2, 3, found));
    CHECK_FALSE(crowded.operators.ring(0, 1, found));
    CHECK(crowded.operators.fans(0, 1, found));
    CHECK(found.tets.size() == 4);
}

TEST_CASE("Operators: an insertion on the surface stops at creases, also those with one patch on both sides") {
    Body body = cut_ball(4, 0.2, 9);
    std::fill(body.patch.begin(), body.patch.end(), 0);
    body.sides.resize(1);
    for (std::size_t k = 0; k < body.points.size(); ++k)
        if (body.stratum[k] == Stratum::patch)
            body.label[k] = 0;
    Bench bench(body, kTolerance);
    int done = 0, beside = 0;
    for (const auto &[key, patch] : bench.complex.sorted_surface())
        for (int k = 0; k < 3; ++k) {
            const int a = key[k], b = key[(k + 1) % 3], c = key[(k + 2) % 3];
            if (bench.complex.curve_of(a, b) < 0)
                continue;
            const Vec3 near = 0.45 * (bench.complex.point(a) + bench.complex.point(b)) + 0.1 * bench.complex.point(c);
            bench.complex.mark();
            if (bench.operators.insert_on_surface(key, near, kInfinity)) {
                CHECK(bench.complex.curve_of(a, b) >= 0);
                ++done;
            }
            bench.complex.rollback();
            ++beside;
        }
    REQUIRE(beside > 20);
    CHECK(done > beside / 3);
}

TEST_CASE("Operators: no facet turns by more than 37 degrees in a collapse, however wide the tolerance") {
    Bench bench(ball(4, 0.2, 7), 0.6);
    int done = 0, refused = 0;
    std::vector<search::TetComplex::SurfaceAt> facets;
    for (const auto &[edge, patch] : bench.complex.sorted_surface())
        for (int k = 0; k < 3; ++k) {
            const int a = edge[k], b = edge[(k + 1) % 3];
            bench.complex.surface_at(a, facets);
            std::vector<std::pair<Facet, Vec3>> before;
            for (const auto &at : facets)
                if (std::find(at.key.begin(), at.key.end(), b) == at.key.end())
                    before.emplace_back(at.key, unit(normal_of(bench.complex.corners(at.key))));
            bench.complex.mark();
            if (bench.operators.collapse(a, b, kInfinity)) {
                for (auto [key, was] : before) {
                    std::replace(key.begin(), key.end(), a, b); // winds as it did
                    const Vec3 is = unit(normal_of(
                        {bench.complex.point(key[0]), bench.complex.point(key[1]), bench.complex.point(key[2])}));
                    CHECK(dot(was, is) >= 0.8 * (1.0 - 1e-12));
                }
                ++done;
            } else {
                ++refused;
            }
            bench.complex.rollback();
        }
    CHECK(done > 20);
    CHECK(refused > 20);
}

TEST_CASE("Operators: a hollow that only one tet would fill is not closed by a collapse") {
    const Body whole = cube(4, 0.3, 21);
    int hollows = 0;
    for (std::size_t t = 0; t < whole.tets.size() && hollows < 40; ++t) {
        const Tet gone = whole.tets[t];
        if (std::any_of(gone.begin(), gone.end(), [&](int v) { return whole.stratum[v] != Stratum::interior; }))
            continue;
        ++hollows;
        std::vector<Tet> tets = whole.tets;
        tets.erase(tets.begin() + static_cast<std::ptrdiff_t>(t));
        const std::size_t count = tets.size();
        Body body = stratified(whole.points, std::move(tets), std::vector<int>(count, 0),
                               [](const Vec3 &, const Vec3 &) { return 0; });
        body.size = whole.size;
        Bench bench(body, 0.6);
        for (const int a : gone)
            for (const int b : gone)
                if (a != b)
                    CHECK_FALSE(bench.operators.collapse(a, b, kInfinity));
    }
    CHECK(hollows == 40);
}

TEST_CASE("Operators: a patch of one facet with a crease all round it stays") {
    const Body round = ball(4, 0.2, 22);
    int patches = 0;
    for (std::size_t k = 0; k < round.facets.size(); k += 7) {
        const auto &[a, b, c] = round.facets[k];
        const Vec3 middle = (1.0 / 3.0) * (round.points[a] + round.points[b] + round.points[c]);
        Body body = stratified(round.points, round.tets, round.regions,
                               [&](const Vec3 &at, const Vec3 &) { return norm(at - middle) < 1e-9 ? 1 : 0; });
        body.size = round.size;
        REQUIRE(body.creases.size() == 3);
        Bench bench(body, 0.6);
        ++patches;
        for (const int from : {a, b, c})
            for (const int to : {a, b, c})
                if (from != to)
                    CHECK_FALSE(bench.operators.collapse(from, to, kInfinity));
    }
    CHECK(patches > 20);
}

} // namespace wct::tests
