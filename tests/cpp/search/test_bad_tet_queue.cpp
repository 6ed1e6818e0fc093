#include "search/bad_tet_queue.h"

#include "support/bench.h"

#include <doctest/doctest.h>

#include <map>
#include <set>
#include <vector>

namespace wct::tests {

namespace {

constexpr double kBad = 1.0, kGood = 0.0;

} // namespace

TEST_CASE("BadTetQueue: the bad tets, the one tried least first, against a list of them") {
    Bench bench(cube(3, 0.1, 1));
    Random random(1), other(2);
    search::BadTetQueue queue(bench.complex, bench.energy, random);
    const int slots = static_cast<int>(bench.complex.tet_slots());
    for (int t = 0; t < slots; ++t)
        bench.complex.set_energy(t, other.below(3) == 0 ? kBad : kGood);
    queue.rebuild();
    std::map<int, int> failures; // of the bad ones
    for (int t = 0; t < slots; ++t)
        if (bench.complex.energy(t) == kBad)
            failures[t] = 0;
    for (int step = 0; step < 3000 && !failures.empty(); ++step) {
        REQUIRE(queue.bad() == static_cast<int>(failures.size()));
        int least = failures.begin()->second;
        for (const auto &[t, count] : failures)
            least = std::min(least, count);
        const int t = queue.next();
        REQUIRE(failures.contains(t));
        REQUIRE(failures[t] == least);
        REQUIRE(queue.failures(t) == least);
        if (other.below(3)) {
            queue.failed(t);
            ++failures[t];
            continue;
        }
        const int changed = other.below(slots), count = other.below(4);
        if (!bench.complex.alive(changed))
            continue;
        const bool bad = other.coin();
        bench.complex.set_energy(changed, bad ? kBad : kGood);
        queue.update({changed}, count);
        if (!bad)
            failures.erase(changed);
        else
            failures.try_emplace(changed, count); // one that was bad keeps its own count
    }
}

TEST_CASE("BadTetQueue: tets that go are no longer in it, those on facets that rule the goal out never are") {
    Bench bench(cube(2, 0.1, 1));
    Random random(3);
    for (int t = 0; t < static_cast<int>(bench.complex.tet_slots()); ++t)
        bench.complex.set_energy(t, kBad);
    const auto [key, patch] = bench.complex.sorted_surface()[0];
    bench.complex.rule_out(key);
    search::BadTetQueue queue(bench.complex, bench.energy, random);
    queue.rebuild();
    CHECK(queue.bad() == static_cast<int>(bench.complex.tets()) - 1);
    const int gone = queue.next();
    bench.complex.remove_tet(gone);
    queue.update({gone}, 0);
    queue.failed(gone); // of one that is not in it nothing is noted
    std::set<int> seen;
    while (queue.bad() > 0) {
        const int t = queue.next();
        CHECK(t != gone);
        CHECK_FALSE(bench.complex.ruled_out(t));
        CHECK(seen.insert(t).second);
        bench.complex.set_energy(t, kGood);
        queue.update({t}, 0);
    }
    CHECK(seen.size() == bench.complex.tets() - 1);
}

} // namespace wct::tests
