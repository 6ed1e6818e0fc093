#pragma once

#include "base/vec3.h"
#include "geometry/box_tree.h"
#include "geometry/closest_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace wct::geometry {

/// A BoxTree over segments (corners = 2) or triangles (corners = 3) with their neighbours: closest points, and the way
/// from piece to piece.
template <std::size_t corners> class PieceTree {
  public:
    using Piece = std::array<Vec3, corners>;

    struct Closest {
        Vec3 point;
        std::int32_t piece;
    };

    explicit PieceTree(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {
        build();
        if constexpr (corners == 3)
            for (const Piece &piece : pieces_)
                frames_.emplace_back(piece);
        find_neighbours();
    }

    const std::vector<Piece> &pieces() const { return pieces_; } // in the tree's own order

    /// `guess` is a piece known or hoped to be near: the better the guess, the less of the tree is visited.
    Closest closest(const Vec3 &x, std::int32_t guess = 0) const {
        Closest best{closest_of(guess, x), guess};
        tree_.minimise(
            dot(best.point - x, best.point - x), [&](std::size_t node) { return tree_.box(node).square(x); },
            [&](std::size_t item, double nearest) {
                const auto piece = static_cast<std::int32_t>(item);
                const Vec3 point = closest_of(piece, x);
                const double square = dot(point - x, point - x);
                if (square < nearest)
                    best = {point, piece};
                return square;
            });
        return best;
    }

    /// From the closest point of the piece to x.
    Vec3 gap(std::int32_t piece, const Vec3 &x) const { return x - closest_of(piece, x); }

    /// Whether the piece is within this squared distance of x.
    bool reaches(std::int32_t piece, const Vec3 &x, double distance) const {
        const Vec3 to = gap(piece, x);
        return dot(to, to) <= distance;
    }

    /// Where the projection of a + t along onto a piece leaves it: t, and the neighbour on that side, or -1.
    struct Exit {
        double t;
        std::int32_t neighbour;
    };
    Exit exit(std::int32_t piece, const Vec3 &a, const Vec3 &along) const {
        const Piece &c = pieces_[static_cast<std::size_t>(piece)];
        const auto &neighbours = neighbours_[static_cast<std::size_t>(piece)];
        // Weights of the corners at a, and how they grow along the way; the one of a corner is 0 on the side opposite.
        std::array<double, corners> weight, rate;
        if constexpr (corners == 3) {
            const TriangleFrame &frame = frames_[static_cast<std::size_t>(piece)];
            const Vec3 d = a - c[0];
            weight = {0.0, dot(d, frame.second), dot(d, frame.third)};
            rate = {0.0, dot(along, frame.second), dot(along, frame.third)};
            weight[0] = 1.0 - weight[1] - weight[2];
            rate[0] = -rate[1] - rate[2];
        } else {
            const Vec3 whole = c[1] - c[0];
            const double scale = 1.0 / dot(whole, whole);
            weight[1] = scale * dot(a - c[0], whole);
            rate[1] = scale * dot(along, whole);
            weight[0] = 1.0 - weight[1];
            rate[0] = -rate[1];
        }
        Exit first{std::numeric_limits<double>::infinity(), -1};
        for (std::size_t i = 0; i < corners; ++i)
            if (rate[i] < 0.0)
                if (const double t = -weight[i] / rate[i]; t < first.t)
                    first = {t, neighbours[i]};
        return first;
    }

    /// The way from `guess` to neighbours that are nearer to x: where it ends, or comes within this squared distance.
    struct Near {
        std::int32_t piece;
        double square; // distance
    };
    Near downhill(const Vec3 &x, double distance, std::int32_t guess) const {
        const auto square = [&](std::int32_t piece) {
            const Vec3 to = gap(piece, x);
            return dot(to, to);
        };
        double best = square(guess);
        for (double before = std::numeric_limits<double>::infinity(); best < before && best > distance;) {
            before = best;
            for (const std::int32_t other : neighbours_[static_cast<std::size_t>(guess)])
                if (other >= 0)
                    if (const double here = square(other); here < best) {
                        best = here;
                        guess = other;
                    }
        }
        return {guess, best};
    }

    /// A piece within this squared distance of x, or -1 if there is none. `guess` is tried first, then the way downhill
    /// from there.
    std::int32_t within(const Vec3 &x, double distance, std::int32_t guess) const {
        if (const Near near = downhill(x, distance, guess); near.square <= distance)
            return near.piece;
        std::int32_t found = -1;
        tree_.visit([&](const Box &box) { return box.square(x) <= distance; },
                    [&](std::size_t item) {
                        if (!reaches(static_cast<std::int32_t>(item), x, distance))
                            return false;
                        found = static_cast<std::int32_t>(item);
                        return true;
                    });
        return found;
    }

    /// Of values of the pieces, at each the least of those that may be within this distance of it.
    std::vector<double> least_around(const std::vector<double> &values, double distance) const {
        const std::vector<double> below = tree_.smallest(values);
        std::vector<double> least;
        least.reserve(values.size());
        for (std::size_t k = 0; k < pieces_.size(); ++k) {
            const Box here = box_of(pieces_[k]);
            const auto near = [&](const Box &box) { return box.square(here) <= distance * distance; };
            constexpr double far = std::numeric_limits<double>::infinity();
            least.push_back(tree_.minimise(
                values[k], [&](std::size_t node) { return near(tree_.box(node)) ? below[node] : far; },
                [&](std::size_t item, double) { return near(box_of(pieces_[item])) ? values[item] : far; }));
        }
        return least;
    }

  private:
    static Box box_of(const Piece &piece) {
        Box box;
        for (const Vec3 &corner : piece)
            box.add(corner);
        return box;
    }

    Vec3 closest_of(std::int32_t piece, const Vec3 &x) const {
        const Piece &c = pieces_[static_cast<std::size_t>(piece)];
        if constexpr (corners == 3)
            return closest_on(c, frames_[static_cast<std::size_t>(piece)], x);
        else
            return closest_on(c, x);
    }

    /// Pieces that share all corners but one.
    void find_neighbours() {
        // Corners by number, equal ones by the same: coordinates as keys would take several times the memory.
        std::vector<std::int32_t> order(corners * pieces_.size()), number(order.size());
        std::iota(order.begin(), order.end(), 0);
        const auto coordinates = [&](std::int32_t corner) {
            const Vec3 &p = pieces_[corner / corners][corner % corners];
            return std::array{p.x, p.y, p.z};
        };
        std::sort(order.begin(), order.end(),
                  [&](std::int32_t a, std::int32_t b) { return coordinates(a) < coordinates(b); });
        for (std::size_t k = 1; k < order.size(); ++k)
            number[order[k]] = number[order[k - 1]] + (coordinates(order[k]) != coordinates(order[k - 1]));
        struct Side {
            std::array<std::int32_t, corners - 1> key; // its corners in ascending order
            std::int32_t piece;
            std::int32_t which;
        };
        std::vector<Side> sides;
        sides.reserve(order.size());
        for (std::size_t p = 0; p < pieces_.size(); ++p)
            for (std::size_t i = 0; i < corners; ++i) {
                Side side{{}, static_cast<std::int32_t>(p), static_cast<std::int32_t>(i)};
                for (std::size_t k = 0; k + 1 < corners; ++k)
                    side.key[k] = number[corners * p + (i + k + 1) % corners];
                std::sort(side.key.begin(), side.key.end());
                sides.push_back(side);
            }
        std::sort(sides.begin(), sides.end(), [](const Side &a, const Side &b) {
            return std::tie(a.key, a.piece, a.which) < std::tie(b.key, b.piece, b.which);
        });
        std::array<std::int32_t, corners> none;
        none.fill(-1);
        neighbours_.assign(pieces_.size(), none);
        for (std::size_t k = 0; k + 1 < sides.size(); ++k)
            if (sides[k].key == sides[k + 1].key) {
                neighbours_[sides[k].piece][sides[k].which] = sides[k + 1].piece;
                neighbours_[sides[k + 1].piece][sides[k + 1].which] = sides[k].piece;
            }
    }

    /// Pieces are halved by the means of their corners along the longest side of the box round them, and put in the
    /// tree's order, so that those of one leaf lie side by side in memory.
    void build() {
        std::vector<Box> boxes;
        boxes.reserve(pieces_.size());
        for (const Piece &piece : pieces_)
            boxes.push_back(box_of(piece));
        const auto middle = [&](std::int32_t k) {
            Vec3 sum;
            for (const Vec3 &corner : pieces_[static_cast<std::size_t>(k)])
                sum += corner;
            return sum;
        };
        tree_ = BoxTree(boxes, [&](const Box &box, std::span<std::int32_t> items, std::size_t half) {
            double Vec3::*const axis = longest_axis(box.hi - box.lo);
            std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
                             [&](std::int32_t i, std::int32_t j) { return middle(i).*axis < middle(j).*axis; });
        });
        std::vector<Piece> ordered;
        ordered.reserve(pieces_.size());
        for (const std::int32_t k : tree_.renumber())
            ordered.push_back(pieces_[static_cast<std::size_t>(k)]);
        pieces_ = std::move(ordered);
    }

    BoxTree tree_;
    std::vector<Piece> pieces_;
    std::vector<TriangleFrame> frames_;                         // of triangles
    std::vector<std::array<std::int32_t, corners>> neighbours_; // of each piece; -1: none
};

} // namespace wct::geometry
