#include "domain/limit_gradient.h"

#include "base/random.h"
#include "domain/local_tolerance.h"
#include "support/bodies.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace wct::tests {

TEST_CASE("limit_gradient: the largest sizes that are no larger and grow no faster") {
    const Body body = ball(3, 0.2, 1);
    const auto around = domain::neighbours(body.facets, body.points.size());
    Random random(1);
    std::vector<double> given;
    for (std::size_t v = 0; v < body.points.size(); ++v)
        given.push_back(0.1 + 2.0 * random.uniform());
    constexpr double grade = 0.4;
    std::vector<double> wanted = given; // by sweeps until nothing changes (Bellman and Ford)
    for (bool again = true; again;) {
        again = false;
        for (std::size_t v = 0; v < wanted.size(); ++v)
            for (const int w : around[v]) {
                const double limit = wanted[v] + grade * norm(body.points[v] - body.points[w]);
                if (limit < wanted[w]) {
                    wanted[w] = limit;
                    again = true;
                }
            }
    }
    std::vector<double> size = given;
    domain::limit_gradient(size, body.points, around, grade);
    CHECK(size == wanted);
    CHECK(size != given);
}

TEST_CASE("neighbours: ascending, each once, both ways") {
    const std::vector<std::array<int, 3>> cells{{3, 0, 1}, {1, 0, 2}};
    const auto around = domain::neighbours(cells, 5);
    CHECK(around == std::vector<std::vector<int>>{{1, 2, 3}, {0, 2, 3}, {0, 1}, {0, 1}, {}});
}

TEST_CASE("local_tolerance: a tenth of a wall, within its bounds") {
    Body slab = cube(4, 0.0, 1);
    for (Vec3 &p : slab.points)
        p.z *= 0.05;
    const domain::Reference reference(slab.surface());
    const Workers workers(2);
    const auto check = [&](double most, double floor, double wanted) {
        const std::vector<double> at = domain::local_tolerance(reference, most, floor, workers);
        for (std::size_t v = 0; v < at.size(); ++v) {
            CHECK(at[v] <= most);
            CHECK(at[v] >= wanted);
            if (slab.points[v].z == 0.0 || slab.points[v].z == 0.05)
                CHECK(at[v] == doctest::Approx(wanted));
        }
    };
    check(0.02, 0.0, 0.005);
    check(0.02, 0.01, 0.01);
    check(0.001, 0.0, 0.001);
}

} // namespace wct::tests
