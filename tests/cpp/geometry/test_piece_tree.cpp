#include "geometry/piece_tree.h"

#include "base/random.h"
#include "geometry/edge_near_pieces.h"
#include "support/bodies.h"
#include "support/closest.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace wct::tests {

using geometry::PieceTree;

namespace {

std::vector<std::array<Vec3, 3>> triangles_of(const Body &body) {
    std::vector<std::array<Vec3, 3>> pieces;
    for (const auto &[a, b, c] : body.facets)
        pieces.push_back({body.points[a], body.points[b], body.points[c]});
    return pieces;
}

std::vector<std::array<Vec3, 2>> helix(int steps) {
    std::vector<std::array<Vec3, 2>> pieces;
    const auto at = [](int k) { return Vec3{std::cos(0.3 * k), std::sin(0.3 * k), 0.02 * k}; };
    for (int k = 0; k < steps; ++k)
        pieces.push_back({at(k), at(k + 1)});
    return pieces;
}

template <std::size_t n> double distance_to(const std::vector<std::array<Vec3, n>> &pieces, const Vec3 &p) {
    long double least = std::numeric_limits<long double>::infinity();
    for (const auto &piece : pieces)
        least = std::min(least, square_to(p, piece));
    return static_cast<double>(std::sqrt(least));
}

template <std::size_t n> void check_closest(const std::vector<std::array<Vec3, n>> &pieces) {
    const PieceTree<n> tree(pieces);
    REQUIRE(tree.pieces().size() == pieces.size());
    Random random(7);
    for (int k = 0; k < 400; ++k) {
        const Vec3 p =
            (k % 2 ? 0.3 : 1.0) * random.normal3() + pieces[random.below(static_cast<int>(pieces.size()))][0];
        const double distance = distance_to(pieces, p);
        const auto guess = random.below(static_cast<int>(pieces.size()));
        const auto found = tree.closest(p, guess);
        REQUIRE(norm(p - found.point) == doctest::Approx(distance).epsilon(1e-9));
        REQUIRE(square_to(found.point, tree.pieces()[found.piece]) < 1e-24L);
        REQUIRE(norm(tree.gap(found.piece, p) - (p - found.point)) < 1e-12);
        for (const double share : {0.5, 0.999999, 1.000001, 2.0}) {
            const double reach = share * distance;
            const std::int32_t within = tree.within(p, reach * reach, guess);
            REQUIRE((within >= 0) == (share > 1.0));
            if (within >= 0)
                REQUIRE(square_to(p, tree.pieces()[within]) <= reach * reach * (1.0 + 1e-12));
        }
        const auto near = tree.downhill(p, 0.0, guess);
        REQUIRE(near.square >= distance * distance * (1.0 - 1e-9));
        REQUIRE(near.square <= static_cast<double>(square_to(p, tree.pieces()[guess])) * (1.0 + 1e-9));
    }
}

/// What all_near says of random edges near the pieces, against distances all along them.
template <std::size_t n> void check_near_along(const std::vector<std::array<Vec3, n>> &pieces, double apart) {
    const PieceTree<n> tree(pieces);
    constexpr geometry::NearAlong along{0.975, 0.985};
    constexpr double tolerance = 0.05;
    constexpr int parts = 60;
    Random random(9);
    int near = 0, off = 0;
    for (int k = 0; k < 800; ++k) {
        const auto &piece = pieces[random.below(static_cast<int>(pieces.size()))];
        const Vec3 a = piece[0] + 0.3 * tolerance * random.normal3();
        const Vec3 b = tree.closest(a + apart * random.normal3()).point + 0.3 * tolerance * random.normal3();
        double most = 0.0;
        for (int i = 0; i <= parts; ++i)
            most = std::max(most, distance_to(pieces, a + (static_cast<double>(i) / parts) * (b - a)));
        std::int32_t first = 0;
        const bool is = along.all_near(tree, a, b, tolerance, first);
        ++(is ? near : off);
        if (is)
            REQUIRE(most <= along.all * tolerance * (1.0 + 1e-9));
        else // an edge that is near everywhere by some room is not refused
            REQUIRE(most + 0.5 * norm(b - a) / parts > along.at * tolerance);
    }
    CHECK(near > 50);
    CHECK(off > 50);
}

} // namespace

TEST_CASE("PieceTree: closest points of triangles and segments") {
    check_closest(triangles_of(ball(3, 0.2, 1)));
    check_closest(helix(57));
    check_closest(std::vector<std::array<Vec3, 2>>{{Vec3{0, 0, 0}, Vec3{1, 0, 0}}});
}

TEST_CASE("NearAlong: edges near all along are told from others") {
    check_near_along(triangles_of(ball(4, 0.2, 1)), 0.3);
    check_near_along(helix(80), 0.3);
}

TEST_CASE("PieceTree: a piece is left on the side that leads to its neighbour") {
    const auto pieces = triangles_of(cube(3, 0.2, 4));
    const PieceTree<3> tree(pieces);
    Random random(3);
    int neighbours = 0;
    for (std::int32_t k = 0; k < static_cast<std::int32_t>(pieces.size()); ++k) {
        const auto &[a, b, c] = tree.pieces()[k];
        const Vec3 from = (1.0 / 3.0) * (a + b + c);
        const Vec3 along = cross(normal_of({a, b, c}), random.normal3()); // in its plane
        const auto exit = tree.exit(k, from, along);
        REQUIRE(exit.t > 0.0);
        const Vec3 x = from + exit.t * along;
        const double scale = norm(b - a) + norm(c - a);
        const double to_side = static_cast<double>(
            std::min({square_to(x, std::array{a, b}), square_to(x, std::array{b, c}), square_to(x, std::array{c, a})}));
        REQUIRE(to_side < 1e-20 * scale);
        if (exit.neighbour < 0)
            continue;
        ++neighbours;
        REQUIRE(square_to(x, tree.pieces()[exit.neighbour]) < 1e-20 * scale);
        REQUIRE(exit.neighbour != k);
    }
    CHECK(neighbours == static_cast<int>(pieces.size())); // the surface of a cube is closed
}

TEST_CASE("closest_on with a frame agrees with closest_on without, within the slack at sides") {
    Random random(6);
    for (int k = 0; k < 20000; ++k) {
        const std::array<Vec3, 3> t{random.normal3(), random.normal3(), random.normal3()};
        const Vec3 p = 2.0 * random.normal3();
        const geometry::TriangleFrame frame(t);
        const double wanted = std::sqrt(static_cast<double>(square_to(p, t)));
        REQUIRE(norm(p - geometry::closest_on(t, p)) == doctest::Approx(wanted).epsilon(1e-9));
        REQUIRE(norm(p - geometry::closest_on(t, frame, p)) == doctest::Approx(wanted).epsilon(1e-7));
        REQUIRE(norm(p - geometry::closest_on(std::array{t[0], t[1]}, p)) ==
                doctest::Approx(std::sqrt(static_cast<double>(square_to(p, std::array{t[0], t[1]})))).epsilon(1e-9));
    }
}

TEST_CASE("PieceTree: the least value around a piece is no more than that of any piece so near, and one of those") {
    const auto pieces = triangles_of(ball(4, 0.2, 1));
    const PieceTree<3> tree(pieces);
    Random random(5);
    std::vector<double> values;
    for (std::size_t k = 0; k < pieces.size(); ++k)
        values.push_back(random.uniform());
    for (const double distance : {0.0, 0.1, 10.0}) {
        const std::vector<double> least = tree.least_around(values, distance);
        REQUIRE(least.size() == values.size());
        for (std::size_t k = 0; k < least.size(); ++k) {
            double near = 1.0, perhaps = 1.0; // of those that are so near, and that may be so
            for (std::size_t j = 0; j < least.size(); ++j) {
                double apart = std::numeric_limits<double>::infinity(); // at most three lengths beyond what it is
                double longest = 0.0;
                for (const Vec3 &corner : tree.pieces()[j])
                    apart = std::min(apart, std::sqrt(static_cast<double>(square_to(corner, tree.pieces()[k]))));
                for (const auto &[a, b, c] : {tree.pieces()[j], tree.pieces()[k]})
                    longest = std::max({longest, norm(b - a), norm(c - b), norm(a - c)});
                if (apart <= distance)
                    near = std::min(near, values[j]);
                if (apart <= distance + 3.0 * longest)
                    perhaps = std::min(perhaps, values[j]);
            }
            REQUIRE(least[k] <= near);
            REQUIRE(least[k] >= perhaps);
        }
    }
}

} // namespace wct::tests
