#include "delaunay/delaunay.h"

#include "base/cells.h"
#include "base/random.h"
#include "delaunay/flat_tets.h"
#include "geometry/dihedral_angles.h"
#include "geometry/predicates.h"
#include "support/neighbours.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace wct::tests {

using delaunay::Triangulation;

namespace {

std::vector<Vec3> scattered(int count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Vec3> points;
    for (int k = 0; k < count; ++k)
        points.push_back(random.normal3());
    return points;
}

std::vector<Vec3> grid(int n) {
    std::vector<Vec3> points;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < n; ++k)
                points.push_back({1.0 * i, 1.0 * j, 1.0 * k});
    return points;
}

/// Whole points on one sphere, many of them on common circles, and its center.
std::vector<Vec3> on_a_sphere() {
    std::vector<Vec3> points{{0, 0, 0}};
    for (int x = -7; x <= 7; ++x)
        for (int y = -7; y <= 7; ++y)
            for (int z = -7; z <= 7; ++z)
                if (x * x + y * y + z * z == 49)
                    points.push_back({1.0 * x, 1.0 * y, 1.0 * z});
    return points;
}

/// Two sheets of points a hair apart, one of them of a lattice.
std::vector<Vec3> flat_slab() {
    Random random(4);
    std::vector<Vec3> points;
    for (int i = 0; i < 7; ++i)
        for (int j = 0; j < 7; ++j) {
            points.push_back({1.0 * i, 1.0 * j, 0.0});
            points.push_back({i + random.uniform(), j + random.uniform(), 1e-9});
        }
    return points;
}

double six_volumes(const std::vector<Vec3> &p, const std::array<int, 4> &t) {
    return dot(p[t[1]] - p[t[0]], cross(p[t[2]] - p[t[0]], p[t[3]] - p[t[0]]));
}

/// What makes it a Delaunay triangulation of all the points, by exact signs and a look at every pair.
void check(const std::vector<Vec3> &points) {
    const Triangulation made = delaunay::delaunay(points);
    std::set<int> used;
    long long on_spheres = 0;
    for (std::size_t k = 0; k < made.tets.size(); ++k) {
        const auto &t = made.tets[k];
        used.insert(t.begin(), t.end());
        REQUIRE(geometry::orient3d(points[t[0]], points[t[1]], points[t[2]], points[t[3]]) == 1);
        for (std::size_t v = 0; v < points.size(); ++v) {
            const int side = geometry::insphere(points[t[0]], points[t[1]], points[t[2]], points[t[3]], points[v]);
            REQUIRE(side <= 0);
            on_spheres += side == 0;
        }
        for (int i = 0; i < 4; ++i) {
            const Vec3 &a = points[t[kFacets[i][0]]], &b = points[t[kFacets[i][1]]], &c = points[t[kFacets[i][2]]];
            if (made.neighbours[k][i] < 0) // the hull: nothing lies beyond it
                for (const Vec3 &p : points)
                    REQUIRE(geometry::orient3d(a, b, c, p) >= 0);
        }
    }
    check_neighbours(made);
    CHECK(used.size() == points.size());
    CHECK(on_spheres >= 4 * static_cast<long long>(made.tets.size()));
}

std::set<std::set<int>> tets_of(const Triangulation &made, const std::vector<int> &name) {
    std::set<std::set<int>> out;
    for (const auto &t : made.tets)
        out.insert({name[t[0]], name[t[1]], name[t[2]], name[t[3]]});
    return out;
}

} // namespace

TEST_CASE("Delaunay: spheres are empty, the hull is convex, neighbours agree") {
    for (const int count : {4, 5, 12, 150})
        check(scattered(count, 7 + count));
    std::vector<Vec3> far = scattered(80, 3);
    for (Vec3 &p : far)
        p += Vec3{1e6, -3e5, 2e7};
    check(far);
    for (Vec3 &p : far)
        p = 0x1p-300 * p;
    check(far);
}

TEST_CASE("Delaunay: points of lattices, of spheres, and all but in one plane") {
    check(grid(4));
    check(on_a_sphere());
    check(flat_slab());
    std::vector<Vec3> plate = grid(3);
    std::erase_if(plate, [](const Vec3 &p) { return p.z > 0.0; });
    plate.push_back({1.0, 1.0, 1e-200});
    check(plate);
}

TEST_CASE("Delaunay: the choice among several does not depend on the numbering") {
    Random random(5);
    for (const auto &points : {grid(4), on_a_sphere(), scattered(100, 9)}) {
        std::vector<int> names(points.size()), order(points.size());
        std::iota(names.begin(), names.end(), 0);
        order = names;
        random.shuffle(order);
        std::vector<Vec3> shuffled;
        for (const int k : order)
            shuffled.push_back(points[k]);
        CHECK(tets_of(delaunay::delaunay(points), names) == tets_of(delaunay::delaunay(shuffled), order));
    }
}

TEST_CASE("Delaunay: what cannot be is refused, with the points' numbers") {
    std::vector<Vec3> points = scattered(10, 2);
    CHECK_THROWS_AS(delaunay::delaunay(std::span(points).first(3)), std::invalid_argument);
    points[7] = points[2];
    try {
        delaunay::delaunay(points);
        FAIL("twins pass");
    } catch (const std::invalid_argument &error) {
        CHECK(std::string(error.what()).find('2') != std::string::npos);
        CHECK(std::string(error.what()).find('7') != std::string::npos);
    }
    points[7].x = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_AS(delaunay::delaunay(points), std::invalid_argument);
    std::vector<Vec3> plane = grid(3);
    for (Vec3 &p : plane)
        p.z = 2.0 * p.x - p.y;
    std::erase_if(plane, [](const Vec3 &p) { return p.x == 0.0 && p.y > 1.5; });
    CHECK_THROWS_AS(delaunay::delaunay(plane), std::invalid_argument);
}

TEST_CASE("remove_flat: no flat tet is left within a label, the volume stays, spheres are empty but for rounding") {
    const std::vector<Vec3> points = [] { // rounding makes flat tets of the faces of cubes
        std::vector<Vec3> out = grid(5);
        Random random(6);
        for (Vec3 &p : out)
            p += 1e-12 * random.normal3();
        return out;
    }();
    constexpr double sharpest = 0.02;
    Triangulation all = delaunay::delaunay(points);
    std::vector<int> label(all.tets.size(), 3);
    const auto on_a_side = [&](const std::array<int, 4> &t) { // flat tets of the hull may stay
        for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z})
            for (const double at : {0.0, 4.0})
                if (std::all_of(t.begin(), t.end(), [&](int v) { return std::abs(points[v].*axis - at) < 1e-6; }))
                    return true;
        return false;
    };
    const auto flat = [&] {
        return std::count_if(all.tets.begin(), all.tets.end(), [&](const auto &t) {
            return !on_a_side(t) &&
                   geometry::smallest_dihedral({points[t[0]], points[t[1]], points[t[2]], points[t[3]]}) < sharpest;
        });
    };
    const auto volume = [&] {
        double sum = 0.0;
        for (const auto &t : all.tets)
            sum += six_volumes(points, t) / 6.0;
        return sum;
    };
    const auto before = flat();
    const double whole = volume();
    REQUIRE(before > 10);
    delaunay::remove_flat(all, label, points, sharpest);
    REQUIRE(label.size() == all.tets.size());
    CHECK(flat() < before / 5);
    CHECK(volume() == doctest::Approx(whole).epsilon(1e-9));
    for (std::size_t k = 0; k < all.tets.size(); ++k) {
        const auto &t = all.tets[k];
        CHECK(label[k] == 3);
        REQUIRE(geometry::orient3d(points[t[0]], points[t[1]], points[t[2]], points[t[3]]) == 1);
    }
    check_neighbours(all);
    Triangulation left = delaunay::delaunay(points);
    const auto tets = left.tets;
    std::vector<int> outside(left.tets.size(), -1);
    delaunay::remove_flat(left, outside, points, sharpest);
    CHECK(left.tets == tets);
}

} // namespace wct::tests
