#include "delaunay/flat_tets.h"

#include "base/random.h"
#include "geometry/dihedral_angles.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <vector>

namespace wct::tests {

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

/// A jittered lattice of n by n points and, exactly over each, another one: all prisms between have their corners on
/// one sphere, and all rectangles on one circle. Turned, so that rounding takes part.
std::vector<Vec3> two_sheets(int n, double apart, std::uint64_t seed) {
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
                const int n = 8, i = v / 2 / n, j = v / 2 % n;
                return std::array{i == 0, j == 0, i == n - 1, j == n - 1}[static_cast<std::size_t>(side)];
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

TEST_CASE("flat tets between two sheets that lie over each other are taken out") {
    constexpr double apart = 0.4, sharpest = 5.0 * kDegree;
    std::size_t flat = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const std::vector<Vec3> points = two_sheets(8, apart, seed);
        delaunay::Triangulation all = delaunay::delaunay(points);
        std::vector<int> label = label_of(all, points);
        for (std::size_t t = 0; t < all.tets.size(); ++t)
            flat += label[t] >= 0 && smallest(points, all.tets[t]) < sharpest;
        delaunay::remove_flat(all, label, points, sharpest);

        REQUIRE(label.size() == all.tets.size());
        CHECK(volume_of(all, label, points) == doctest::Approx(49.0 * apart).epsilon(1e-12));
        for (std::size_t t = 0; t < all.tets.size(); ++t) {
            if (label[t] >= 0)
                CHECK(smallest(points, all.tets[t]) >= sharpest);
            for (int i = 0; i < 4; ++i) {
                const int other = all.neighbours[t][i];
                if (other < 0)
                    continue;
                const Tet &beyond = all.tets[static_cast<std::size_t>(other)];
                int shared = 0;
                for (int k = 0; k < 4; ++k)
                    shared += k != i && std::count(beyond.begin(), beyond.end(), all.tets[t][k]) == 1;
                REQUIRE(shared == 3);
                const auto &back = all.neighbours[static_cast<std::size_t>(other)];
                REQUIRE(std::count(back.begin(), back.end(), static_cast<int>(t)) == 1);
            }
        }
    }
    CHECK(flat > 100); // there was something to take out
}

} // namespace wct::tests
