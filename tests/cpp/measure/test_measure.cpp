#include "base/parallel.h"
#include "measure/circumcentric_dual.h"
#include "measure/tet_shapes.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <vector>

using namespace wct;

namespace {

/// A regular tet of edge 2 sqrt 2, and one of three right angles at its first corner.
const std::vector<Vec3> kPoints{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1},
                                {0, 0, 0}, {1, 0, 0},   {0, 1, 0},   {0, 0, 1}};
const std::vector<Tet> kTets{{0, 2, 1, 3}, {4, 5, 6, 7}};

} // namespace

TEST_CASE("measure: a regular tet and a corner of a cube in closed form") {
    std::array<std::vector<double>, 8> rows;
    for (auto &row : rows)
        row.resize(2);
    std::array<std::int8_t, 2> worst{};
    std::array<std::array<bool, 2>, 3> flags{};
    measure::measure(
        kPoints, kTets,
        {rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7], worst, flags[0], flags[1], flags[2]},
        Workers(2));
    const auto degrees = [](double radians) { return radians * 180.0 / std::numbers::pi; };
    CHECK(rows[0][0] == doctest::Approx(1.0 / 3.0));
    CHECK(rows[1][0] == doctest::Approx(1.0 / 3.0));
    CHECK(rows[2][0] == doctest::Approx(60.0));
    CHECK(rows[3][0] == doctest::Approx(60.0));
    CHECK(rows[4][0] == doctest::Approx(degrees(std::acos(1.0 / 3.0))));
    CHECK(rows[5][0] == doctest::Approx(degrees(std::acos(1.0 / 3.0))));
    CHECK(rows[6][0] == doctest::Approx(std::sqrt(3.0 / 8.0)));
    CHECK(std::fabs(rows[7][0]) == doctest::Approx(8.0 / 3.0));
    CHECK((flags[0][0] && flags[1][0] && flags[2][0]));

    // The circumcenter of the corner is the cube's middle, 1/2 over the facets at the right angles, and beyond the
    // other.
    CHECK(rows[0][1] == doctest::Approx(-1.0 / 3.0));
    CHECK(worst[1] == 0);
    CHECK(rows[1][1] == doctest::Approx(1.0 / std::sqrt(3.0)));
    CHECK(rows[2][1] == doctest::Approx(45.0));
    CHECK(rows[3][1] == doctest::Approx(90.0));
    CHECK(rows[7][1] == doctest::Approx(1.0 / 6.0));
    CHECK_FALSE((flags[0][1] || flags[1][1] || flags[2][1]));

    std::array<double, 2> found{};
    measure::circumradii(kPoints, kTets, found, Workers());
    CHECK(found[0] == doctest::Approx(std::sqrt(3.0)));
    CHECK(found[1] == doctest::Approx(std::sqrt(3.0) / 2.0));
    const std::array<double, 4> bins{0.0, 60.0, 80.0, 180.0};
    CHECK(measure::dihedral_counts(kPoints, kTets, bins, Workers()) == std::vector<std::int64_t>{3, 6, 3});
}

TEST_CASE("circumcentric dual: parts of a regular tet and of a corner of a cube add up to their volumes") {
    const std::vector<measure::TetEdges> edges{{0, 1, 2, 3, 4, 5}, {6, 7, 8, 9, 10, 11}};
    std::array<double, 8> heights{}, errors{};
    std::array<double, 12> sums{}, doubts{};
    measure::edge_sums(kPoints, kTets, edges, {}, heights, errors, sums, doubts, Workers(2));
    for (int i = 0; i < 4; ++i)
        CHECK(heights[i] == doctest::Approx(1.0 / std::sqrt(3.0)));
    for (int e = 0; e < 6; ++e) // two facets, cot 60 degrees times the height each
        CHECK(sums[e] == doctest::Approx(2.0 / 3.0));
    double volume = 0.0;
    for (int e = 0; e < 6; ++e) // l^2 / 12 times the sum, at both ends together
        volume += sums[6 + e] * (e < 3 ? 1.0 : 2.0) / 12.0;
    CHECK(volume == doctest::Approx(1.0 / 6.0));
    for (const double error : errors)
        CHECK(error < 1e-12);

    std::array<double, 2> unsigned_volume{};
    measure::unsigned_volumes(kPoints, kTets, unsigned_volume, Workers());
    CHECK(unsigned_volume[0] == doctest::Approx(8.0 / 3.0));
    CHECK(unsigned_volume[1] > 1.0 / 6.0 + 0.01);

    const std::array<double, 2> twice{2.0, -1.0};
    std::array<double, 12> more{};
    measure::edge_sums(kPoints, kTets, edges, twice, heights, errors, more, doubts, Workers());
    CHECK(more[0] == doctest::Approx(2.0 * sums[0]));
    CHECK(more[7] == doctest::Approx(-sums[7]));
}
