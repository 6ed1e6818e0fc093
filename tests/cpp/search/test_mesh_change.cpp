#include "search/mesh_change.h"

#include "support/bench.h"
#include "support/state.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

namespace wct::tests {

namespace {

/// Bodies whose kicks change all that there is: interfaces, creases, curved patches with landmarks.
Body body_of(int k) {
    return k == 0 ? cube(3, 0.3, 12) : k == 1 ? cube(4, 0.3, 13, 0.5) : ball(4, 0.2, 14);
}

/// What the repair of t has come to, whatever it is: where all is bad, kicks reach everywhere.
search::Attempt repaired(Bench &bench, int t, std::uint64_t seed) {
    return bench.attempt(seed, [&] {
        bench.repair.improve(search::Repair::recipes[2], t);
        return true;
    });
}

bool meet(const search::MeshChange &a, const search::MeshChange &b) {
    std::vector<int> both;
    std::ranges::set_intersection(a.touched, b.touched, std::back_inserter(both));
    return !both.empty();
}

} // namespace

TEST_CASE("MeshChange: done to another copy it leads to the same mesh, and the attempt leaves no trace") {
    for (int k = 0; k < 3; ++k) {
        Bench made(body_of(k));
        int changed = 0;
        for (std::uint64_t seed = 1; seed <= 40; ++seed) {
            const std::vector<int> tets = living(made.complex);
            const int t = tets[(seed * 37) % tets.size()];
            const State before(made.complex);
            search::TetComplex copy = made.complex;
            Content wanted(copy);
            const search::Attempt attempt = made.attempt(seed, [&] {
                made.kick.at(t, 0);
                wanted = Content(made.complex);
                return true;
            });
            REQUIRE(difference(before, State(made.complex)) == "");
            copy.apply(*attempt.change);
            REQUIRE(Content(copy) == wanted);
            REQUIRE(copy.total() - before.total == doctest::Approx(attempt.gain).epsilon(1e-9));
            REQUIRE(living(made.complex).size() + attempt.change->tets.size() ==
                    copy.tets() + attempt.change->gone_tets.size());
            made.complex.apply(*attempt.change); // the next one starts from here
            REQUIRE(difference(State(copy), State(made.complex)) == "");
            REQUIRE(fault(copy) == "");
            changed += !attempt.change->tets.empty();
        }
        CHECK(changed > 20);
    }
}

TEST_CASE("MeshChange: two that touch no vertex in common come to the same in either order") {
    int pairs = 0;
    for (const Body &body : {cube(6, 0.2, 13, 0.5), ball(6, 0.0, 14)}) {
        Bench made(body);
        REQUIRE(fault(made.complex) == "");
        const std::vector<int> tets = living(made.complex);
        for (std::uint64_t seed = 1; seed <= 20; ++seed) {
            const search::Attempt first = repaired(made, tets[7 * seed], seed);
            const search::Attempt second = repaired(made, tets[tets.size() - 7 * seed], seed + 1000);
            if (meet(*first.change, *second.change))
                continue;
            ++pairs;
            search::TetComplex one = made.complex, other = made.complex;
            one.apply(*first.change);
            one.apply(*second.change);
            other.apply(*second.change);
            other.apply(*first.change);
            REQUIRE(fault(one) == "");
            REQUIRE(Content(one) == Content(other));
            REQUIRE(one.total() - made.complex.total() == doctest::Approx(first.gain + second.gain).epsilon(1e-9));
        }
    }
    CHECK(pairs > 10);
}

} // namespace wct::tests
