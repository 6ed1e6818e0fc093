#include "delaunay/flat_tets.h"

#include "base/random.h"
#include "geometry/dihedral_angles.h"
#include "support/neighbours.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <vector>

namespace wct::tests {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kSide = 8; // points along a side of the lattice

/// A jittered lattice and, exactly over each of its points, another one: all prisms between have their corners on one
/// sphere, and all rectangles on one circle. Turned, so that rounding takes part.
std::vector<Vec3> two_sheets(double apart, std::uint64_t seed) {
    constexpr int n = kSide;
    Random random(seed);
    const Vec3 u = unit(random.normal3()), v = unit(cross(u, random.normal3())), w = cross(u, v);
    std::vector<Vec3> points;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const bool rim = i == 0 || j == 0 || i == n - 1 || j == n - 1;
            const double x = i + (rim ? 0.0 : 0.4 * (random.uniform() - 0.5)),
                         y = j + (rim ? 0.0 : 0.4 * (random.uniform() - 0.5));
            for (const double z : {0.0, apart})
                points.push_back(x * u + y * v + z * w);
        }
    return points;
}

double smallest(const std::vector<Vec3> &points, const Tet &tet) {
    return geometry::smallest_dihedral({points[tet[0]], points[tet[1]], points[tet[2]], points[tet[3]]});
}

/// Flat tets in the hull count as outside.
std::vector<int> label_of(const delaunay::Triangulation &all, const std::vector<Vec3> &points) {
    std::vector<int> label;
    for (const Tet &tet : all.tets) {
        const bool one_sheet = std::all_of(tet.begin(), tet.end(), [&](int v) { return v % 2 == tet[0] % 2; });
        const double volume = six_volumes(points[tet[0]], points[tet[1]], points[tet[2]], points[tet[3]]);
        const auto on_rim = [&](int side) {
            return std::all_of(tet.begin(), tet.end(), [&](int v) {
                const int i = v / 2 / kSide, j = v / 2 % kSide;
                return std::array{i == 0, j == 0, i == kSide - 1, j == kSide - 1}[static_cast<std::size_t>(side)];
            });
        };
        const bool in_hull = one_sheet || on_rim(0) || on_rim(1) || on_rim(2) || on_rim(3);
        label.push_back(in_hull && volume < 1e-9 ? -1 : 0);
    }
    return label;
}

double volume_of(const delaunay::Triangulation &all, const std::vector<int> &label, const std::vector<Vec3> &points) {
    double sum = 0.0;
    for (std::size_t t = 0; t < all.tets.size(); ++t)
        if (const auto &[a, b, c, d] = all.tets[t]; label[t] >= 0)
            sum += six_volumes(points[a], points[b], points[c], points[d]) / 6.0;
    return sum;
}

} // namespace

TEST_CASE("remove_flat: none is left between two sheets that lie over each other") {
    constexpr double apart = 0.4, sharpest = 5.0 * kDegree;
    std::size_t flat = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const std::vector<Vec3> points = two_sheets(apart, seed);
        delaunay::Triangulation all = delaunay::delaunay(points);
        std::vector<int> label = label_of(all, points);
        for (std::size_t t = 0; t < all.tets.size(); ++t)
            flat += label[t] >= 0 && smallest(points, all.tets[t]) < sharpest;
        delaunay::remove_flat(all, label, points, sharpest);

        REQUIRE(label.size() == all.tets.size());
        CHECK(volume_of(all, label, points) == doctest::Approx((kSide - 1) * (kSide - 1) * apart).epsilon(1e-12));
        for (std::size_t t = 0; t < all.tets.size(); ++t)
            if (label[t] >= 0)
                CHECK(smallest(points, all.tets[t]) >= sharpest);
        check_neighbours(all);
    }
    CHECK(flat > 100); // there was something to take out
}

} // namespace wct::tests
