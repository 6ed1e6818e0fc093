#include "sampling/cloud.h"

#include "base/random.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>
#include <vector>

namespace wct::tests {

TEST_CASE("PointGrid: crowded where a point is closer than the mean of the radii, by a look at all") {
    Random random(1);
    sampling::PointGrid grid;
    std::vector<std::pair<Vec3, double>> added;
    int crowded = 0;
    for (int k = 0; k < 800; ++k) {
        const Vec3 p = 0.3 * random.normal3();
        const double radius =
            std::ldexp(0.2 * random.uniform() + 1e-3, -random.below(k % 4 ? 6 : 18)); // far finer ones too
        bool wanted = false;
        for (const auto &[q, other] : added)
            wanted = wanted || norm(p - q) < 0.5 * (radius + other);
        REQUIRE(grid.crowded(p, radius) == wanted);
        crowded += wanted;
        if (!wanted || random.coin()) {
            grid.add(p, radius);
            added.emplace_back(p, radius);
        }
    }
    CHECK(crowded > 50);
}

TEST_CASE("PointGrid: a place farther off than cells have numbers is not crowded, and is looked up at once") {
    sampling::PointGrid grid;
    for (int k = 0; k < 100; ++k)
        grid.add({0.01 * k, 0, 0}, 0.02);
    for (const double far : {1e15, 1e19, 1e30, 1e300, std::numeric_limits<double>::infinity()})
        for (const double sign : {-1.0, 1.0}) {
            CHECK_FALSE(grid.crowded({sign * far, 0, 0}, 0.02));
            CHECK_FALSE(grid.crowded({0, sign * far, sign * far}, 0.02));
            grid.add({sign * far, far, 0}, 0.02);
        }
    CHECK_FALSE(grid.crowded({std::numeric_limits<double>::quiet_NaN(), 0, 0}, 0.02));
    CHECK(grid.crowded({0.5, 0, 0}, 0.02));
}

TEST_CASE("drop_twins: of points in one place the least free stays, given ones always") {
    sampling::Cloud cloud;
    cloud.add({1, 0, 0}, Stratum::interior, 0, 0.1);
    cloud.add({0, 0, 0}, Stratum::patch, 1, 0.1);
    cloud.add({1, 0, 0}, Stratum::crease, 2, 0.1);
    cloud.add({0, 0, 0}, Stratum::patch, 3, 0.1);
    cloud.add({2, 0, 0}, Stratum::interior, 4, 0.1);
    cloud.add({2, 0, 0}, Stratum::interior, 5, 0.1);
    cloud.held[5] = sampling::Hold::given;
    CHECK(sampling::drop_twins(cloud));
    std::set<int> labels(cloud.label.begin(), cloud.label.end());
    CHECK(labels == std::set<int>{1, 2, 5});
    CHECK_FALSE(sampling::drop_twins(cloud));
    cloud.keep({1, 0, 1});
    CHECK(cloud.count() == 2);
    sampling::Cloud twice = cloud;
    twice.append(cloud);
    CHECK(twice.count() == 4);
}

} // namespace wct::tests
