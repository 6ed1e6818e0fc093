#include "energy/energy.h"

#include "base/cells.h"
#include "base/random.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace wct::tests {

namespace {

using Corners = std::array<Vec3, 4>;

const Corners kRegular{Vec3{1, 1, 1}, Vec3{-1, 1, -1}, Vec3{1, -1, -1}, Vec3{-1, -1, 1}};
const Corners kOrthogonal{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};

energy::TetLanes lanes_of(const Corners &tet) {
    energy::TetLanes lanes;
    for (int i = 0; i < 4; ++i)
        lanes.set_all(i, tet[i]);
    return lanes;
}

double energy_of(const Corners &tet, const energy::EnergyForm &form) {
    energy::ShapeLanes shape;
    energy::Lanes energy;
    energy::measure(lanes_of(tet), true, shape);
    energy::penalize(shape, form, energy::flatness_terms(energy::kDegenerate), energy);
    return energy[3];
}

/// The circumcenter by Cramer's rule, and from it the signed height over the facet opposite each corner, over R.
std::array<double, 4> heights_of(const Corners &p) {
    const Vec3 u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0];
    const double det = dot(u, cross(v, w));
    const Vec3 center =
        p[0] + (0.5 / det) * (dot(u, u) * cross(v, w) + dot(v, v) * cross(w, u) + dot(w, w) * cross(u, v));
    std::array<double, 4> heights;
    for (int i = 0; i < 4; ++i) {
        const Vec3 &o = p[kFacets[i][0]];
        const Vec3 inward = unit(cross(p[kFacets[i][1]] - o, p[kFacets[i][2]] - o));
        heights[i] = dot(center - o, inward) / norm(center - p[0]);
    }
    return heights;
}

Corners random_tet(Random &random) {
    Corners tet;
    for (;;) {
        for (Vec3 &p : tet)
            p = random.normal3();
        if (dot(tet[1] - tet[0], cross(tet[2] - tet[0], tet[3] - tet[0])) < 0.0)
            std::swap(tet[2], tet[3]);
        double longest = 0.0;
        for (const auto &[i, j] : kEdges)
            longest = std::max(longest, norm(tet[i] - tet[j]));
        if (dot(tet[1] - tet[0], cross(tet[2] - tet[0], tet[3] - tet[0])) > 0.01 * longest * longest * longest)
            return tet;
    }
}

} // namespace

TEST_CASE("measure: closed forms of the regular tet and of the corner of a cube") {
    energy::ShapeLanes shape;
    energy::measure(lanes_of(kRegular), true, shape);
    for (int lane = 0; lane < energy::kLanes; ++lane) {
        for (const energy::Lanes &height : shape.height)
            CHECK(height[lane] == doctest::Approx(1.0 / 3.0));
        for (const energy::Lanes &cosine : shape.cosine)
            CHECK(cosine[lane] == doctest::Approx(0.5));
        CHECK(shape.flatness[lane] == doctest::Approx(1.0 / std::sqrt(2.0)));
    }
    energy::measure(lanes_of(kOrthogonal), true, shape);
    CHECK(shape.height[0][0] < 0.0); // the center lies beyond the large facet: half-way to its mirror image
    CHECK(shape.height[0][0] == doctest::Approx(-1.0 / 3.0));
    for (int i = 1; i < 4; ++i)
        CHECK(shape.height[i][0] == doctest::Approx(1.0 / std::sqrt(3.0)));
    std::array<double, 12> cosines;
    for (int k = 0; k < 12; ++k)
        cosines[k] = shape.cosine[k][0];
    std::sort(cosines.begin(), cosines.end());
    for (int k = 0; k < 12; ++k)
        CHECK(cosines[k] == doctest::Approx(k < 3 ? 0.0 : k < 6 ? 0.5 : std::sqrt(0.5)));
}

TEST_CASE("measure and measure_worst agree with Cramer's rule") {
    Random random(1);
    for (int k = 0; k < 300; ++k) {
        const Corners tet = random_tet(random);
        const auto wanted = heights_of(tet);
        energy::ShapeLanes shape;
        energy::WorstLanes worst;
        energy::measure(lanes_of(tet), true, shape);
        energy::measure_worst(lanes_of(tet), true, worst);
        double cosine = 1.0;
        for (const energy::Lanes &one : shape.cosine)
            cosine = std::min(cosine, one[0]);
        for (int i = 0; i < 4; ++i)
            CHECK(shape.height[i][0] == doctest::Approx(wanted[i]).epsilon(1e-9));
        CHECK(worst.height[0] == doctest::Approx(*std::min_element(wanted.begin(), wanted.end())).epsilon(1e-9));
        CHECK(worst.cosine[0] == doctest::Approx(cosine));
        CHECK(worst.flatness[0] == doctest::Approx(shape.flatness[0]));
    }
}

TEST_CASE("penalize: nothing in the regular tet, the formula elsewhere, infinity beyond a bound") {
    CHECK(energy_of(kRegular, {0.1, 2.0, 0.1, 2.0, 1.0, 0.0}) == 0.0);
    CHECK(energy_of(kRegular, {0.4, 2.0, 0.1, 2.0, 1.0, 0.0}) ==
          doctest::Approx(4.0 * (0.4 - 1.0 / 3.0) * (0.4 - 1.0 / 3.0)));
    CHECK(energy_of(kRegular, {0.1, 2.0, 0.6, 3.0, 2.0, 0.0}) == doctest::Approx(2.0 * 12.0 * 0.1 * 0.1 * 0.1));
    CHECK(energy_of(kRegular, {0.0, 2.0, 0.0, 2.0, 0.0, 5.0}) == doctest::Approx(0.0).epsilon(1e-12));
    // The corner of a cube: one height of -1/3, three right angles.
    const double over = 0.12 + 1.0 / 3.0, off = 1.0 / std::sqrt(3.0) - 1.0 / 3.0;
    CHECK(energy_of(kOrthogonal, {0.12, 2.5, 0.08, 1.5, 0.7, 0.2}) ==
          doctest::Approx(std::pow(over, 2.5) + 0.7 * 3.0 * std::pow(0.08, 1.5) + 0.2 * (4.0 / 9.0 + 3.0 * off * off)));
    CHECK(energy_of({kRegular[1], kRegular[0], kRegular[2], kRegular[3]}, {}) ==
          std::numeric_limits<double>::infinity());
}

TEST_CASE("differentiate: slopes are those of differences, at all corners and at the first alone") {
    Random random(2);
    const energy::EnergyForm form{0.5, 2.5, 0.6, 2.5, 0.7, 0.2};
    for (int k = 0; k < 200; ++k) {
        const Corners tet = random_tet(random);
        const energy::TetLanes lanes = lanes_of(tet);
        energy::ShapeLanes shape;
        energy::SlopeLanes slopes;
        energy::Lanes energy, first[3];
        energy::GradientLanes gradient;
        energy::measure(lanes, true, shape);
        energy::penalize(shape, form, energy::flatness_terms(energy::kDegenerate), energy, slopes);
        energy::differentiate(lanes, shape, slopes, true, gradient);
        energy::differentiate_first(lanes, shape, slopes, true, first);
        for (int i = 0; i < 4; ++i)
            for (int axis = 0; axis < 3; ++axis) {
                constexpr double h = 1e-6;
                Corners up = tet, down = tet;
                double Vec3::*at = axis == 0 ? &Vec3::x : axis == 1 ? &Vec3::y : &Vec3::z;
                up[i].*at += h;
                down[i].*at -= h;
                const double wanted = (energy_of(up, form) - energy_of(down, form)) / (2.0 * h);
                CHECK(gradient.corner[i][axis][5] == doctest::Approx(wanted).epsilon(1e-4).scale(1.0));
                if (i == 0)
                    CHECK(first[axis][5] == doctest::Approx(gradient.corner[0][axis][5]).epsilon(1e-9).scale(1.0));
            }
    }
}

TEST_CASE("Lanes never mix: each tet has the bits that it has alone") {
    Random random(3);
    energy::TetLanes lanes;
    std::array<Corners, energy::kLanes> tets;
    for (int lane = 0; lane < energy::kLanes; ++lane) {
        tets[lane] = random_tet(random);
        for (int i = 0; i < 4; ++i)
            lanes.set(lane, i, tets[lane][i]);
    }
    energy::ShapeLanes shape;
    energy::Lanes energy;
    energy::measure(lanes, true, shape);
    energy::penalize(shape, {0.5, 2.5, 0.6, 2.5, 0.7, 0.2}, energy::flatness_terms(energy::kDegenerate), energy);
    for (int lane = 0; lane < energy::kLanes; ++lane)
        CHECK(energy[lane] == energy_of(tets[lane], {0.5, 2.5, 0.6, 2.5, 0.7, 0.2}));
}

} // namespace wct::tests
