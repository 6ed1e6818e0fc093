#include "search/mesh_change.h"

#include "search/workbench.h"
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

/// A body, measured, and a workbench for it.
struct Measured {
    explicit Measured(Body made)
        : body(std::move(made)), complex(complex_of(body)), guide(guide_of(body, 0.02, 0.125 * body.size)),
          bench(complex, guide, search_form(), search::SearchOptions(), false) {
        bench.watch.begin();
        for (std::size_t t = 0; t < complex.tet_slots(); ++t)
            complex.set_energy(static_cast<int>(t), bench.energy.of_present(complex, complex.tet(static_cast<int>(t))));
        complex.resum();
    }
    Measured(const Measured &) = delete;
    Measured &operator=(const Measured &) = delete;

    /// What the repair of t has come to, whatever it is: where all is bad, kicks reach everywhere.
    search::Attempt repair(int t, std::uint64_t seed) {
        return bench.attempt(seed, [&] {
            bench.repair.improve(search::Repair::recipes[2], t);
            return true;
        });
    }
    std::vector<int> living() const {
        std::vector<int> tets;
        for (std::size_t t = 0; t < complex.tet_slots(); ++t)
            if (complex.alive(static_cast<int>(t)))
                tets.push_back(static_cast<int>(t));
        return tets;
    }

    Body body;
    search::TetComplex complex;
    search::SurfaceGuide guide;
    search::Workbench bench;
};

bool meet(const search::MeshChange &a, const search::MeshChange &b) {
    std::vector<int> both;
    std::ranges::set_intersection(a.touched, b.touched, std::back_inserter(both));
    return !both.empty();
}

} // namespace

TEST_CASE("MeshChange: done to another copy it leads to the same mesh, and the attempt leaves no trace") {
    for (int k = 0; k < 3; ++k) {
        Measured made(body_of(k));
        int changed = 0;
        for (std::uint64_t seed = 1; seed <= 40; ++seed) {
            const std::vector<int> tets = made.living();
            const int t = tets[(seed * 37) % tets.size()];
            const State before(made.complex);
            search::TetComplex copy = made.complex;
            Content wanted(copy);
            const search::Attempt attempt = made.bench.attempt(seed, [&] {
                made.bench.kick.at(t, 0);
                wanted = Content(made.complex);
                return true;
            });
            REQUIRE(difference(before, State(made.complex)) == "");
            copy.apply(*attempt.change);
            REQUIRE(Content(copy) == wanted);
            REQUIRE(copy.total() - before.total == doctest::Approx(attempt.gain).epsilon(1e-9));
            REQUIRE(std::ssize(made.living()) + attempt.change->growth() == static_cast<long>(copy.tets()));
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
        Measured made(body);
        REQUIRE(fault(made.complex) == "");
        const std::vector<int> tets = made.living();
        for (std::uint64_t seed = 1; seed <= 20; ++seed) {
            const search::Attempt first = made.repair(tets[7 * seed], seed);
            const search::Attempt second = made.repair(tets[tets.size() - 7 * seed], seed + 1000);
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
