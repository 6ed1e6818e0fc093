#include "base/cells.h"
#include "base/monitor.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/vec3.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace wct::tests {

TEST_CASE("Random: SplitMix64 of the seed 0 as published, and uniform below any number") {
    Random random(0);
    CHECK(random.next() == 0xe220a8397b1dcdafull);
    CHECK(random.next() == 0x6e789e6aa1b965f4ull);
    CHECK(random.next() == 0x06c45d188009454full);
    std::vector<int> seen(7, 0);
    for (int k = 0; k < 7000; ++k)
        ++seen[random.below(7)];
    for (const int count : seen)
        CHECK(std::abs(count - 1000) < 150);
    double sum = 0.0, square = 0.0;
    for (int k = 0; k < 20000; ++k) {
        const double x = random.normal();
        sum += x;
        square += x * x;
    }
    CHECK(sum / 20000 == doctest::Approx(0.0).scale(1.0).epsilon(0.03));
    CHECK(square / 20000 == doctest::Approx(1.0).epsilon(0.05));
    std::vector<int> items{1, 2, 3, 4, 5, 6}, shuffled = items;
    random.shuffle(shuffled);
    CHECK(std::is_permutation(items.begin(), items.end(), shuffled.begin()));
}

TEST_CASE("Workers: every item once whatever the threads, and of what is thrown the first chunk's") {
    for (const unsigned threads : {1u, 2u, 5u})
        for (const std::size_t count : {0ul, 1ul, 7ul, 64ul, 1000ul}) {
            std::vector<int> seen(count, 0);
            const Workers workers(threads);
            workers.for_each(count, 8, [&](std::size_t i) { ++seen[i]; });
            CHECK(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
            if (count < 64)
                continue;
            std::string thrown;
            try {
                workers.for_each(count, 8, [](std::size_t i) {
                    if (i % 20 == 19)
                        throw std::runtime_error(std::to_string(i));
                });
            } catch (const std::runtime_error &error) {
                thrown = error.what();
            }
            CHECK(thrown == "19");
        }
}

TEST_CASE("Workers: what is taken in order adds up to the same bits whatever the threads") {
    for (const std::size_t count : {0ul, 1ul, 64ul, 65ul, 5000ul}) {
        double straight = 0.0;
        for (std::size_t i = 0; i < count; ++i)
            straight += std::sin(static_cast<double>(i));
        for (const unsigned threads : {1u, 2u, 5u}) {
            double sum = 0.0;
            std::size_t next = 0;
            Workers(threads).in_order<std::vector<double>>(
                count, 64,
                [](std::size_t first, std::size_t last, std::vector<double> &part) {
                    part.clear();
                    for (std::size_t i = first; i < last; ++i)
                        part.push_back(std::sin(static_cast<double>(i)));
                },
                [&](std::size_t first, std::size_t last, const std::vector<double> &part) {
                    CHECK(first == next);
                    CHECK(part.size() == last - first);
                    next = last;
                    for (const double value : part)
                        sum += value;
                });
            CHECK(next == count);
            CHECK(sum == straight);
        }
    }
}

TEST_CASE("Monitor: stages add up, and a stop is for good") {
    std::vector<double> heard;
    Monitor monitor([&](double done, std::int64_t bad) {
        heard.push_back(done);
        return bad != 7;
    });
    monitor.begin(0.25);
    CHECK(monitor.work(10, 0.5)); // too little to be told of
    CHECK(heard.empty());
    CHECK(monitor.work(1 << 20, 1.0));
    monitor.begin(0.75);
    CHECK(monitor.work(1 << 20, 0.5));
    CHECK(heard == std::vector<double>{0.25, 0.625});
    monitor.set_bad(7);
    CHECK_FALSE(monitor.work(1 << 20, 0.6));
    monitor.set_bad(0);
    CHECK_FALSE(monitor.work(1 << 20, 0.7));
    CHECK(heard.size() == 3);
    CHECK(monitor.evaluations() == 10 + 4ll * (1 << 20));
}

TEST_CASE("Facets wind towards the corner opposite; ascend sorts and tells the sense") {
    const Vec3 corners[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 4; ++i) {
        const Vec3 &a = corners[kFacets[i][0]], &b = corners[kFacets[i][1]], &c = corners[kFacets[i][2]];
        CHECK(dot(cross(b - a, c - a), corners[i] - a) > 0.0);
    }
    Facet even{3, 1, 2}, odd{2, 1, 3};
    CHECK(ascend(even));
    CHECK_FALSE(ascend(odd));
    CHECK(even == Facet{1, 2, 3});
    CHECK(odd == even);
}

TEST_CASE("Vectors: angles are right near 0 and half a turn") {
    CHECK(angle({1, 0, 0}, {1, 1e-9, 0}) == doctest::Approx(1e-9));
    CHECK(std::numbers::pi - angle({1, 0, 0}, {-1, 1e-9, 0}) == doctest::Approx(1e-9).epsilon(1e-6));
    CHECK(unit({0, 0, 0}) == Vec3{0, 0, 0});
    CHECK(norm(unit({3, 4, 12})) == doctest::Approx(1.0));
}

} // namespace wct::tests
