#include "search/operators.h"

#include "base/random.h"
#include "support/bench.h"
#include "support/closest.h"
#include "support/state.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>

namespace wct::tests {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 0.02;

enum class Kind { edges, facets, collapses, splits, inserts, surface_inserts, relaxations, groups, nudges };
constexpr int kKinds = 9;
const std::string kNames[kKinds] = {"remove_edge",       "flip_23", "collapse",    "split", "insert",
                                    "insert_on_surface", "relax",   "relax_round", "nudge"};

int any_tet(const search::TetComplex &complex, Random &random) {
    for (;;)
        if (const int t = random.below(static_cast<int>(complex.tet_slots())); complex.alive(t))
            return t;
}

Vec3 inside(const search::TetComplex &complex, std::span<const int> corners, Random &random) {
    Vec3 x;
    double sum = 0.0;
    for (const int v : corners) {
        const double weight = 0.2 + random.uniform();
        x += weight * complex.point(v);
        sum += weight;
    }
    return (1.0 / sum) * x;
}

/// Applies the operator at a random place; whether it was carried out.
bool apply(Bench &bench, Kind kind, double slack, Random &random) {
    const int t = any_tet(bench.complex, random);
    const Tet tet = bench.complex.tet(t);
    const int *e = kEdges[random.below(6)];
    const int a = tet[e[0]], b = tet[e[1]], i = random.below(4), v = tet[i];
    switch (kind) {
    case Kind::edges:
        return bench.operators.remove_edge(a, b, slack);
    case Kind::facets:
        return bench.operators.flip_23(t, i, slack);
    case Kind::collapses:
        return random.coin() ? bench.operators.collapse(a, b, slack) : bench.operators.collapse(b, a, slack);
    case Kind::splits:
        return bench.operators.split(a, b, slack).has_value();
    case Kind::inserts:
        return bench.operators.insert(t, inside(bench.complex, tet, random), slack).has_value();
    case Kind::surface_inserts: {
        const auto surface = bench.complex.sorted_surface();
        const Facet key = surface[random.below(static_cast<int>(surface.size()))].first;
        return bench.operators.insert_on_surface(key, inside(bench.complex, key, random), slack).has_value();
    }
    case Kind::relaxations:
        return bench.descent.relax(v, 4);
    case Kind::groups:
        return bench.group.relax_round(t);
    default:
        return bench.descent.nudge(v, bench.complex.point(v) + (0.15 * bench.body.size) * random.normal3());
    }
}

/// Greatest distance of points all over the facet to its patch.
double distance_to_patch(const Body &body, const std::array<Vec3, 3> &corners, int patch) {
    constexpr int parts = 6;
    long double most = 0;
    for (int i = 0; i <= parts; ++i)
        for (int j = 0; i + j <= parts; ++j) {
            const double u = static_cast<double>(i) / parts, v = static_cast<double>(j) / parts;
            const Vec3 p = u * corners[0] + v * corners[1] + (1.0 - u - v) * corners[2];
            long double least = std::numeric_limits<long double>::infinity();
            for (std::size_t k = 0; k < body.facets.size(); ++k)
                if (body.patch[k] == patch) {
                    const auto &[a, b, c] = body.facets[k];
                    least = std::min(least, square_to(p, std::array{body.points[a], body.points[b], body.points[c]}));
                }
            most = std::max(most, least);
        }
    return static_cast<double>(std::sqrt(most));
}

/// The first surface facet that is farther from its patch than the tolerance, or landmark so far from its facet.
std::string surface_fault(const Bench &bench, const std::set<Facet> &known) {
    for (const auto &[key, patch] : bench.complex.sorted_surface()) {
        const std::array<Vec3, 3> corners = bench.complex.corners(key);
        for (int l = bench.complex.facet(key).landmark; l >= 0; l = bench.complex.next_landmark(l)) {
            if (!(bench.complex.landmark_owner(l) == key))
                return "a landmark's owner is another facet than the one that lists it";
            if (bench.complex.over(key) == 0.0 &&
                square_to(bench.guide.landmarks()[l].point, corners) > kTolerance * kTolerance)
                return "a landmark is off its facet";
        }
        if (known.contains(key) || bench.complex.over(key) > 0.0)
            continue;
        if (distance_to_patch(bench.body, corners, patch) > kTolerance)
            return "a facet is off its patch";
    }
    return "";
}

std::set<Facet> surface_of(const search::TetComplex &complex) {
    std::set<Facet> keys;
    for (const auto &[key, patch] : complex.sorted_surface())
        keys.insert(key);
    return keys;
}

/// Stored energies are those of the tets as they are now.
std::string energy_fault(const Bench &bench) {
    for (std::size_t k = 0; k < bench.complex.tet_slots(); ++k) {
        const int t = static_cast<int>(k);
        if (!bench.complex.alive(t))
            continue;
        const double is = bench.energy.of_present(bench.complex, bench.complex.tet(t));
        if (!(std::abs(is - bench.complex.energy(t)) <= 1e-12 * (1.0 + std::abs(is))))
            return "the stored energy of a tet is not its own";
    }
    return "";
}

/// Of all tets, without the counts.
double smooth_energy(const Bench &bench) {
    search::SearchForm form = bench.energy.form();
    form.count = form.hard_count = 0.0;
    const search::SearchEnergy energy(form);
    double sum = 0.0;
    for (std::size_t k = 0; k < bench.complex.tet_slots(); ++k)
        if (const int t = static_cast<int>(k); bench.complex.alive(t))
            sum += energy.of_present(bench.complex, bench.complex.tet(t));
    return sum;
}

std::size_t landmarks(const search::TetComplex &complex) {
    std::size_t count = 0;
    for (const State::OfFacet &facet : State(complex).facets)
        count += facet.landmarks.size();
    return count;
}

/// Greatest distance of points all along the edge to the curve.
double distance_to_curve(const Body &body, const Vec3 &a, const Vec3 &b, int curve) {
    constexpr int parts = 8;
    long double most = 0;
    for (int i = 0; i <= parts; ++i) {
        const Vec3 p = a + (static_cast<double>(i) / parts) * (b - a);
        long double least = std::numeric_limits<long double>::infinity();
        for (std::size_t k = 0; k < body.creases.size(); ++k)
            if (body.curve[k] == curve)
                least = std::min(
                    least, square_to(p, std::array{body.points[body.creases[k][0]], body.points[body.creases[k][1]]}));
        most = std::max(most, least);
    }
    return static_cast<double>(std::sqrt(most));
}

/// Creases stay near their curves, have the ends they had, and lead from one to the other: every vertex of a curve has
/// two edges of it but for its ends.
std::string crease_fault(const Bench &bench) {
    std::map<std::pair<int, int>, int> degree; // by curve and vertex
    for (const auto &[edge, curve] : bench.complex.creases()) {
        if (distance_to_curve(bench.body, bench.complex.point(edge[0]), bench.complex.point(edge[1]), curve) >
            kTolerance)
            return "a crease is off its curve";
        for (const int v : edge)
            ++degree[{curve, v}];
    }
    for (const auto &[at, count] : degree) {
        const Stratum stratum = bench.complex.vertex(at.second).stratum;
        if (stratum == Stratum::crease ? count != 2 : count != 1)
            return "a crease is broken or branches";
    }
    return "";
}

struct Tally {
    int done[kKinds] = {}, refused[kKinds] = {};
};

/// Operators at random places of a body: what they promise, each time.
Tally try_operators(Bench &bench, int tries, std::uint64_t seed, bool planar) {
    Random random(seed);
    Tally tally;
    const std::vector<double> volume = volumes(bench.complex);
    const std::vector<int> euler = characteristics(bench.complex);
    const std::size_t owned = landmarks(bench.complex);
    REQUIRE(fault(bench.complex) == "");
    for (int k = 0; k < tries; ++k) {
        const int kind = random.below(kKinds);
        const double slack = random.coin() ? kInfinity : 2.0 * random.uniform() - 0.5;
        CAPTURE(kNames[kind]);
        CAPTURE(k);
        const State before(bench.complex);
        const std::set<Facet> known = surface_of(bench.complex);
        const double smooth = smooth_energy(bench);
        bench.complex.mark();
        const bool done = apply(bench, static_cast<Kind>(kind), slack, random);
        ++(done ? tally.done : tally.refused)[kind];
        if (!done) {
            const bool makes_vertex = kind == 3 || kind == 4 || kind == 5; // and leaves it to the rollback
            if (!makes_vertex)
                REQUIRE(difference(before, State(bench.complex)) == "");
            bench.complex.rollback();
            REQUIRE(difference(before, State(bench.complex)) == "");
            continue;
        }
        REQUIRE(fault(bench.complex) == "");
        REQUIRE(crease_fault(bench) == "");
        REQUIRE(energy_fault(bench) == "");
        REQUIRE(surface_fault(bench, known) == "");
        REQUIRE(landmarks(bench.complex) == owned);
        if (kind <= 5)
            REQUIRE(bench.complex.gain() < slack);
        if (kind == 6)
            REQUIRE(smooth_energy(bench) < smooth);
        const std::vector<double> now = volumes(bench.complex);
        for (std::size_t r = 0; planar && r < volume.size(); ++r)
            REQUIRE(now[r] == doctest::Approx(volume[r]).epsilon(1e-12));
        if (random.below(3) == 0) {
            REQUIRE(pinch(bench.complex) == "");
            REQUIRE(characteristics(bench.complex) == euler);
            bench.complex.commit();
            continue;
        }
        bench.complex.rollback();
        REQUIRE(difference(before, State(bench.complex)) == "");
    }
    return tally;
}

} // namespace

TEST_CASE("Operators keep a cube sound, or refuse and leave every bit") {
    Bench bench(cube(3, 0.3, 5), kTolerance);
    const Tally tally = try_operators(bench, 3000, 1, true);
    for (int kind = 0; kind < kKinds; ++kind) {
        CAPTURE(kNames[kind]);
        CHECK(tally.done[kind] > 10);
        CHECK(tally.refused[kind] > 10);
    }
}

TEST_CASE("Operators keep two regions and the facets between them") {
    Bench bench(cube(3, 0.3, 6, 1.0 / 3.0), kTolerance);
    const Tally tally = try_operators(bench, 3000, 2, true);
    for (int kind = 0; kind < kKinds; ++kind) {
        CAPTURE(kNames[kind]);
        CHECK(tally.done[kind] > 10);
    }
}

TEST_CASE("Operators hold a curved surface within the tolerance, both ways") {
    Bench bench(ball(4, 0.2, 7), kTolerance);
    REQUIRE(bench.complex.over_count() == 0);
    const Tally tally = try_operators(bench, 1500, 3, false);
    for (int kind = 0; kind < kKinds; ++kind) {
        CAPTURE(kNames[kind]);
        CHECK(tally.done[kind] > 5);
    }
}

TEST_CASE("Operators hold curved creases between planes and a curved patch") {
    Bench bench(cylinder(4, 0.2, 8), kTolerance);
    REQUIRE(bench.complex.over_count() == 0);
    try_operators(bench, 1500, 4, false);
}

TEST_CASE("Operators: where a facet goes on beyond its patch, the farthest place is on the patch's rim") {
    constexpr double tolerance = 0.04;
    const Body body = cylinder(4, 0.2, 9);
    Body high = body; // its round side covers that of the cylinder, and more
    for (Vec3 &p : high.points)
        p.z += p.z - 0.5;
    search::TetComplex complex = complex_of(high);
    const search::SurfaceGuide guide = guide_of(body, tolerance, 0.125 * body.size);
    const search::SearchEnergy energy(search_form());
    search::SurfaceWatch watch(complex, guide);
    search::Operators operators(complex, energy, guide, watch);
    watch.begin();
    int beyond = 0, within = 0;
    for (const auto &[key, patch] : complex.sorted_surface()) {
        if (guide.planar(patch))
            continue;
        const std::array<Vec3, 3> corners = complex.corners(key);
        for (int l = complex.facet(key).landmark; l >= 0; l = complex.next_landmark(l))
            REQUIRE(square_to(guide.landmarks()[l].point, corners) < tolerance * tolerance);
        const auto found = operators.farthest(key);
        if (!found) {
            const Vec3 middle = (1.0 / 3.0) * (corners[0] + corners[1] + corners[2]);
            CHECK(distance_to_patch(body, {middle, middle, middle}, patch) <= tolerance);
            ++within;
            continue;
        }
        CHECK(std::abs(found->z - 0.5) == doctest::Approx(0.5).epsilon(1e-12));
        CHECK(distance_to_patch(body, {*found, *found, *found}, patch) < 1e-12);
        ++beyond;
    }
    CHECK(beyond > 5);
    CHECK(within > 5);
}

TEST_CASE("Operators: a curve drawn on a plane stays where it is, though all facets at it are in the plane") {
    const Body plain = cube(6, 0.1, 24);
    // A spot on the upper side: its rim goes in steps along the lattice.
    Body body = stratified(plain.points, plain.tets, plain.regions, [](const Vec3 &middle, const Vec3 &normal) {
        const bool spot = middle.z > 0.999 && norm(middle - Vec3{0.5, 0.5, 1.0}) < 0.36;
        return spot                         ? 6
               : std::abs(normal.z) > 0.999 ? (normal.z > 0.0 ? 0 : 1)
               : std::abs(normal.y) > 0.999 ? (normal.y > 0.0 ? 2 : 3)
                                            : (normal.x > 0.0 ? 4 : 5);
    });
    body.size = plain.size;
    Bench bench(body, 0.05);
    const auto on_spot = [](const Vec3 &p) { return p.z == 1.0 && norm(p - Vec3{0.5, 0.5, 1.0}) < 0.49; };
    int done = 0, refused = 0;
    for (const auto &[edge, curve] : bench.complex.sorted_creases()) {
        if (!on_spot(bench.complex.point(edge[0])) || !on_spot(bench.complex.point(edge[1])))
            continue;
        for (const auto &[a, b] : {edge, Edge{edge[1], edge[0]}}) {
            bench.complex.mark();
            const bool collapsed = bench.operators.collapse(a, b, kInfinity);
            ++(collapsed ? done : refused);
            for (const auto &[now, its] : bench.complex.sorted_creases())
                REQUIRE(distance_to_curve(body, bench.complex.point(now[0]), bench.complex.point(now[1]), its) <= 0.05);
            bench.complex.rollback();
        }
    }
    CHECK(done > 0);
    CHECK(refused > 10);
}

} // namespace wct::tests
