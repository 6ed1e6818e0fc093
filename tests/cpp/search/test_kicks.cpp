#include "search/kicks.h"

#include "search/sweeps.h"
#include "support/bench.h"
#include "support/state.h"

#include <doctest/doctest.h>

namespace wct::tests {

namespace {

/// A bench with what tries changes of it.
struct KickBench : Bench {
    explicit KickBench(Body made, std::uint64_t seed)
        : Bench(std::move(made)), chance(seed), crew(*this, guide, options), sweeps(crew, chance), kicks(crew, chance) {
    }

    std::vector<int> bad() const {
        std::vector<int> out = living(complex);
        std::erase_if(out, [&](int t) { return !energy.bad(complex.energy(t)); });
        return out;
    }

    search::SearchOptions options;
    Random chance;
    search::Crew crew;
    search::Sweeps sweeps;
    search::Kicks kicks;
};

} // namespace

TEST_CASE("Repair: a pass lowers the energy and leaves a mesh") {
    for (const int recipe : {0, 1, 2}) {
        KickBench bench(cube(4, 0.3, 11), 1);
        double before = bench.complex.total();
        const std::size_t bad = bench.bad().size();
        REQUIRE(bad > 50);
        for (int pass = 0; pass < 2; ++pass) {
            bench.repair.pass(search::Repair::recipes[recipe], bench.bad());
            bench.complex.resum();
            CHECK(bench.complex.total() < before);
            before = bench.complex.total();
            CHECK(fault(bench.complex) == "");
        }
        CHECK(bench.bad().size() < bad);
        CHECK(characteristics(bench.complex) == std::vector<int>{1});
        CHECK(volumes(bench.complex)[0] == doctest::Approx(1.0).epsilon(1e-12));
    }
}

TEST_CASE("Kicks: what is not allowed is taken back, what is allowed stays") {
    KickBench bench(cube(3, 0.3, 12), 1);
    bench.kicks.restart();
    const State before(bench.complex);
    int asked = 0;
    bench.kicks.allowed = [&](const search::Workbench &) {
        ++asked;
        return false;
    };
    for (int k = 0; k < 20; ++k)
        CHECK_FALSE(bench.kicks.once().better);
    CHECK(asked > 0);
    CHECK(difference(before, State(bench.complex)) == "");
    bench.kicks.allowed = nullptr;
    for (int k = 0; k < 20 && bench.kicks.bad() > 0; ++k)
        bench.kicks.once();
    CHECK(difference(before, State(bench.complex)) != "");
}

TEST_CASE("Sweeps: good tets are left alone, and so is what was tried in vain until something changes near it") {
    KickBench bench(cube(3, 0.3, 12), 1);
    std::vector<int> good = living(bench.complex);
    std::erase_if(good, [&](int t) { return bench.energy.bad(bench.complex.energy(t)); });
    const State untouched(bench.complex);
    bench.sweeps.run(2, good);
    CHECK(difference(untouched, State(bench.complex)) == "");

    for (int pass = 0; pass < 40; ++pass)
        bench.sweeps.run(0, bench.bad());
    const State still(bench.complex);
    const long evaluations = bench.energy.evaluations();
    bench.sweeps.run(0, bench.bad());
    CHECK(difference(still, State(bench.complex)) == "");
    CHECK(bench.energy.evaluations() == evaluations); // not even tried
    bench.sweeps.run(1, bench.bad());                 // by this recipe they were not
    CHECK(bench.energy.evaluations() > evaluations);
}

TEST_CASE("Repair: where a facet is beyond the tolerance, its vertex that is nearest goes to the farthest place") {
    const Body coarse = ball(3, 0.2, 15), fine = ball(9, 0.2, 15);
    search::TetComplex complex = complex_of(coarse);
    const search::SurfaceGuide guide = guide_of(fine, 0.02, 0.125 * fine.size);
    search::SearchOptions options;
    options.seed = 4;
    search::Workbench bench(complex, guide, search_form(), options, false);
    bench.watch.begin();
    bench.watch.loose = 3.0; // as kicks allow
    int snapped = 0, left = 0;
    for (std::size_t k = 0; k < complex.tet_slots(); ++k) {
        const int t = static_cast<int>(k);
        const Tet tet = complex.tet(t);
        std::vector<std::array<Vec3, 4>> places; // the vertices of a facet beyond the tolerance, and where it is
        for (const auto &f : kFacets)
            if (complex.is_surface(tet[f[0]], tet[f[1]], tet[f[2]])) {
                const Facet key = sorted(tet[f[0]], tet[f[1]], tet[f[2]]);
                const auto peak = complex.over(key) > 0.0 ? bench.operators.farthest(key) : std::nullopt;
                if (peak)
                    places.push_back({complex.point(key[0]), complex.point(key[1]), complex.point(key[2]), *peak});
            }
        const State before(complex);
        const auto v = bench.repair.snap(t);
        if (!v) {
            CHECK(difference(before, State(complex)) == "");
            left += !places.empty();
            continue;
        }
        ++snapped;
        const Vec3 was = before.vertices[*v].position, is = complex.point(*v);
        CHECK(std::any_of(places.begin(), places.end(), [&](const std::array<Vec3, 4> &at) {
            const double far = norm(was - at[3]);
            return (was == at[0] || was == at[1] || was == at[2]) && norm(is - at[3]) < 0.9 * far &&
                   far <= std::min({norm(at[0] - at[3]), norm(at[1] - at[3]), norm(at[2] - at[3])});
        }));
    }
    CHECK(snapped > 10);
    CHECK(left > 10);
}

TEST_CASE("Repair: flips round vertices lower the energy, and random operators may raise it") {
    KickBench bench(cube(4, 0.3, 13), 1);
    const double before = bench.complex.total();
    std::vector<int> vertices;
    for (std::size_t v = 0; v < bench.complex.vertex_slots(); ++v)
        vertices.push_back(static_cast<int>(v));
    bench.operators.touched.clear();
    bench.repair.flip_round(vertices);
    bench.complex.resum();
    CHECK(bench.complex.total() < before);
    CHECK(fault(bench.complex) == "");
    int done = 0, raised = 0;
    for (int k = 0; k < 150; ++k) {
        const std::vector<int> bad = bench.bad();
        REQUIRE_FALSE(bad.empty());
        const double was = bench.complex.total();
        done += bench.repair.random_operator(bad[static_cast<std::size_t>(k) % bad.size()], 4.0);
        raised += bench.complex.total() > was + 0.1;
        REQUIRE(fault(bench.complex) == "");
    }
    CHECK(done > 20);
    CHECK(raised > 5);
}

TEST_CASE("Kicks: a kick that is not kept leaves every bit, one that is leaves a mesh that is not worse") {
    KickBench bench(ball(4, 0.2, 14), 3);
    for (int pass = 0; pass < 3; ++pass)
        bench.repair.pass(search::Repair::recipes[1], bench.bad());
    bench.kicks.restart();
    REQUIRE(bench.kicks.bad() > 3);
    constexpr double equal = 0.02 + 1e-9; // what a kick may raise the energy by
    int better = 0, undone = 0, even = 0;
    for (int k = 0; k < 80 && bench.kicks.bad() > 0; ++k) {
        const State before(bench.complex);
        const int bad = bench.kicks.bad(), over = bench.complex.over_count();
        const bool tried = bench.kicks.tried();
        const bool won = bench.kicks.once().better;
        const std::string moved = difference(before, State(bench.complex));
        CHECK(bench.kicks.bad() == static_cast<int>(bench.bad().size()));
        CHECK(bench.complex.over_count() <= over);
        if (won) {
            ++better;
            CHECK(bench.complex.total() < before.total - 0.1);
        } else if (moved.empty()) {
            ++undone;
            CHECK(bench.kicks.bad() == bad);
        } else {
            ++even;
            if (!tried)
                CHECK(bench.complex.total() <= before.total + equal);
        }
        if (k % 30 == 0)
            REQUIRE(fault(bench.complex) == "");
    }
    CHECK(better > 2);
    CHECK(undone > 10);
    CHECK(fault(bench.complex) == "");
    CHECK(pinch(bench.complex) == "");
}

} // namespace wct::tests
