#include "geometry/box_tree.h"

#include "base/random.h"
#include "support/closest.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>
#include <vector>

namespace wct::tests {

using geometry::Box;
using geometry::BoxTree;

namespace {

std::vector<Box> random_boxes(int count, Random &random) {
    std::vector<Box> boxes(count);
    for (Box &box : boxes) {
        const Vec3 at = random.normal3();
        box.add(at);
        if (random.coin()) // others are points, or the same as the one before
            box.add(at + 0.2 * random.normal3());
        if (&box != &boxes[0] && random.below(5) == 0)
            box = *(&box - 1);
    }
    return boxes;
}

constexpr int kSizes[] = {0, 1, 2, 4, 5, 9, 100, 1000};

} // namespace

TEST_CASE("BoxTree: the smallest value and the items in a box are those of a look at all items") {
    Random random(1);
    for (const int count : kSizes) {
        const std::vector<Box> boxes = random_boxes(count, random);
        const BoxTree tree(boxes);
        CHECK(tree.empty() == (count == 0));
        for (int k = 0; k < 50; ++k) {
            const Vec3 p = random.normal3();
            double least = random.coin() ? std::numeric_limits<double>::infinity() : 0.05;
            const double found = tree.minimise(
                least, [&](std::size_t node) { return tree.box(node).square(p); },
                [&](std::size_t item, double) { return boxes[item].square(p); });
            std::set<std::size_t> wanted, seen;
            for (std::size_t i = 0; i < boxes.size(); ++i) {
                least = std::min(least, boxes[i].square(p));
                if (boxes[i].contains(p))
                    wanted.insert(i);
            }
            REQUIRE(found == least);
            tree.visit([&](const Box &box) { return box.contains(p); },
                       [&](std::size_t item) {
                           if (boxes[item].contains(p))
                               REQUIRE(seen.insert(item).second);
                           return false;
                       });
            REQUIRE(seen == wanted);
        }
    }
}

TEST_CASE("BoxTree: a visit ends with the first item that is accepted") {
    Random random(2);
    const std::vector<Box> boxes = random_boxes(50, random);
    const BoxTree tree(boxes);
    int visits = 0;
    const auto all = [](const Box &) { return true; };
    CHECK(tree.visit(all, [&](std::size_t) { return ++visits == 7; }));
    CHECK(visits == 7);
    CHECK_FALSE(tree.visit(all, [&](std::size_t) { return ++visits < 0; }));
    CHECK(visits == 57);
}

TEST_CASE("BoxTree: smallest is the least value below each node") {
    Random random(3);
    const std::vector<Box> boxes = random_boxes(300, random);
    const BoxTree tree(boxes);
    std::vector<double> values;
    for (std::size_t i = 0; i < boxes.size(); ++i)
        values.push_back(random.normal());
    const std::vector<double> least = tree.smallest(values);
    REQUIRE(least.size() == tree.nodes());
    CHECK(least[0] == *std::min_element(values.begin(), values.end()));
    // With it as a bound the search finds the smallest value of the boxes that contain a point.
    for (int k = 0; k < 100; ++k) {
        const Vec3 p = random.normal3();
        double wanted = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < boxes.size(); ++i)
            if (boxes[i].contains(p))
                wanted = std::min(wanted, values[i]);
        const auto found = tree.minimise(
            std::numeric_limits<double>::infinity(), [&](std::size_t node) { return least[node]; },
            [&](std::size_t i, double) {
                return boxes[i].contains(p) ? values[i] : std::numeric_limits<double>::infinity();
            });
        REQUIRE(found == wanted);
    }
}

TEST_CASE("Closest points of segments and triangles, thin ones among them") {
    Random random(4);
    for (int k = 0; k < 20000; ++k) {
        const Vec3 p = random.normal3();
        std::array<Vec3, 3> t{random.normal3(), random.normal3(), random.normal3()};
        if (k % 4 == 1)
            t[2] = t[0] + 1e-4 * random.normal3();
        if (k % 4 == 2)
            t[2] = t[0] + random.normal() * (t[1] - t[0]) + 1e-3 * random.normal3();
        const auto on_side = geometry::nearest_on_segment(p, t[0], t[1]);
        const double side = static_cast<double>(square_to(p, std::array{t[0], t[1]}));
        REQUIRE(on_side.square == doctest::Approx(side).epsilon(1e-12));
        REQUIRE(norm(t[0] + on_side.along * (t[1] - t[0]) - on_side.point) < 1e-14);
        const auto on = geometry::nearest_on_triangle(p, t[0], t[1], t[2]);
        REQUIRE(std::sqrt(on.square) == doctest::Approx(std::sqrt(static_cast<double>(square_to(p, t)))).epsilon(1e-7));
        REQUIRE(norm(on.weight[0] * t[0] + on.weight[1] * t[1] + on.weight[2] * t[2] - on.point) < 1e-13);
        REQUIRE(on.weight[0] + on.weight[1] + on.weight[2] == doctest::Approx(1.0));
        REQUIRE(std::min({on.weight[0], on.weight[1], on.weight[2]}) >= -1e-12);
        REQUIRE(geometry::with_room(on.square, 5.0) > on.square);
    }
}

TEST_CASE("A ray meets a triangle where Cramer's rule says, and the boxes round it") {
    Random random(5);
    int hits = 0;
    for (int k = 0; k < 20000; ++k) {
        const std::array<Vec3, 3> t{random.normal3(), random.normal3(), random.normal3()};
        const Vec3 p = random.normal3(), d = k % 3 ? random.normal3() : Vec3{1.0, 0.0, 0.0};
        const double at = geometry::ray_triangle(p, d, 0.0, t[0], t[1], t[2]);
        Box box;
        for (const Vec3 &q : t)
            box.add(q);
        const Vec3 inverse = geometry::inverse_of(d);
        if (!std::isinf(at)) {
            ++hits;
            REQUIRE(static_cast<double>(std::sqrt(square_to(p + at * d, t))) < 1e-8 * (1.0 + norm(at * d)));
            REQUIRE(geometry::ray_box(p, inverse, box) <= at * (1.0 + 1e-9));
            REQUIRE(std::isinf(geometry::ray_triangle(p, d, at, t[0], t[1], t[2])));
            continue;
        }
        // No hit: its line, looked at closely, passes by the triangle or meets it behind.
        const Vec3 u = t[1] - t[0], v = t[2] - t[0], r = p - t[0];
        const double det = dot(u, cross(v, -1.0 * d));
        const double second = dot(r, cross(v, -1.0 * d)) / det, third = dot(u, cross(r, -1.0 * d)) / det;
        const double along = dot(u, cross(v, r)) / det;
        REQUIRE_FALSE((second > 1e-9 && third > 1e-9 && second + third < 1.0 - 1e-9 && along > 1e-9));
    }
    CHECK(hits > 500);
}

TEST_CASE("A ray along the faces of a box meets it, whichever way and with whatever sign of zero") {
    Box box;
    box.add(Vec3{0.0, 0.0, 1.0});
    box.add(Vec3{1.0, 2.0, 3.0});
    for (const double zero : {0.0, -0.0})
        for (const Vec3 &from : {Vec3{0.0, 0.0, 0.0}, Vec3{1.0, 0.0, 0.0}, Vec3{1.0, 2.0, 0.0}, Vec3{0.5, 1.0, 0.0}}) {
            CHECK(geometry::ray_box(from, geometry::inverse_of({zero, zero, 1.0}), box) == 1.0);
            CHECK(std::isinf(geometry::ray_box(from, geometry::inverse_of({zero, zero, -1.0}), box)));
            const Vec3 beyond = from + Vec3{0.0, 0.0, 4.0};
            CHECK(geometry::ray_box(beyond, geometry::inverse_of({zero, zero, -1.0}), box) == 1.0);
            const Vec3 beside = from + Vec3{2.0, 0.0, 0.0};
            CHECK(std::isinf(geometry::ray_box(beside, geometry::inverse_of({zero, zero, 1.0}), box)));
        }
}

} // namespace wct::tests
