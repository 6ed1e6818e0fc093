#pragma once

#include "base/vec3.h"
#include "geometry/closest_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

namespace wct::geometry {

/// A tree of bounding boxes over segments (corners = 2) or triangles (corners = 3), for closest points.
template <std::size_t corners> class BoundingTree {
  public:
    using Piece = std::array<Vec3, corners>;

    struct Closest {
        Vec3 point;
        std::int32_t piece;
    };

    explicit BoundingTree(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {
        if (!pieces_.empty())
            split(0, static_cast<std::int32_t>(pieces_.size()));
        if constexpr (corners == 3)
            for (const Piece &piece : pieces_)
                frames_.emplace_back(piece);
        find_neighbours();
    }

    const std::vector<Piece> &pieces() const { return pieces_; } // in the tree's own order

    /// `guess` is a piece known or hoped to be near: the better the guess, the less of the tree is visited.
    Closest closest(const Vec3 &x, std::int32_t guess = 0) const {
        Closest best{closest_of(guess, x), guess};
        double distance = dot(best.point - x, best.point - x);
        struct Waiting {
            std::int32_t node;
            double distance;
        };
        std::array<Waiting, 64> stack; // the tree halves: no deeper than the bits of a count
        std::size_t size = 0;
        stack[size++] = {0, 0.0};
        while (size) {
            const Waiting next = stack[--size];
            if (next.distance >= distance)
                continue;
            const Node &node = nodes_[static_cast<std::size_t>(next.node)];
            if (node.right < 0) {
                for (std::int32_t i = node.first; i < node.last; ++i) {
                    const Vec3 point = closest_of(i, x);
                    const double d = dot(point - x, point - x);
                    if (d < distance) {
                        distance = d;
                        best = {point, i};
                    }
                }
                continue;
            }
            Waiting nearer{next.node + 1, nodes_[static_cast<std::size_t>(next.node) + 1].squared_distance(x)};
            Waiting farther{node.right, nodes_[static_cast<std::size_t>(node.right)].squared_distance(x)};
            if (farther.distance < nearer.distance)
                std::swap(nearer, farther);
            if (farther.distance < distance)
                stack[size++] = farther;
            if (nearer.distance < distance)
                stack[size++] = nearer;
        }
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
        std::array<std::int32_t, 64> stack;
        std::size_t size = 0;
        stack[size++] = 0;
        while (size) {
            const std::int32_t index = stack[--size];
            const Node &node = nodes_[static_cast<std::size_t>(index)];
            if (node.squared_distance(x) > distance)
                continue;
            if (node.right >= 0) {
                stack[size++] = node.right;
                stack[size++] = index + 1;
                continue;
            }
            for (std::int32_t i = node.first; i < node.last; ++i)
                if (reaches(i, x, distance))
                    return i;
        }
        return -1;
    }

  private:
    static constexpr std::int32_t kLeaf = 4;

    struct Node {
        Vec3 low;
        Vec3 high;
        std::int32_t first;
        std::int32_t last;
        std::int32_t right = -1; // the left child follows its parent; a leaf has none

        double squared_distance(const Vec3 &x) const {
            const Vec3 d{std::max({low.x - x.x, 0.0, x.x - high.x}), std::max({low.y - x.y, 0.0, x.y - high.y}),
                         std::max({low.z - x.z, 0.0, x.z - high.z})};
            return dot(d, d);
        }
    };

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

    static Vec3 middle(const Piece &piece) {
        Vec3 sum;
        for (const Vec3 &corner : piece)
            sum += corner;
        return sum;
    }

    std::int32_t split(std::int32_t first, std::int32_t last) {
        constexpr double huge = std::numeric_limits<double>::infinity();
        Node node{{huge, huge, huge}, {-huge, -huge, -huge}, first, last};
        for (std::int32_t i = first; i < last; ++i)
            for (const Vec3 &corner : pieces_[static_cast<std::size_t>(i)]) {
                node.low = {std::min(node.low.x, corner.x), std::min(node.low.y, corner.y),
                            std::min(node.low.z, corner.z)};
                node.high = {std::max(node.high.x, corner.x), std::max(node.high.y, corner.y),
                             std::max(node.high.z, corner.z)};
            }
        const auto index = static_cast<std::int32_t>(nodes_.size());
        nodes_.push_back(node);
        if (last - first > kLeaf) {
            const Vec3 extent = node.high - node.low;
            double Vec3::*axis = extent.x >= extent.y && extent.x >= extent.z ? &Vec3::x
                                 : extent.y >= extent.z                       ? &Vec3::y
                                                                              : &Vec3::z;
            const std::int32_t half = first + (last - first) / 2;
            std::nth_element(pieces_.begin() + first, pieces_.begin() + half, pieces_.begin() + last,
                             [axis](const Piece &a, const Piece &b) { return middle(a).*axis < middle(b).*axis; });
            split(first, half);
            const std::int32_t right = split(half, last);
            nodes_[static_cast<std::size_t>(index)].right = right;
        }
        return index;
    }

    std::vector<Piece> pieces_;
    std::vector<TriangleFrame> frames_; // of triangles
    std::vector<Node> nodes_;
    std::vector<std::array<std::int32_t, corners>> neighbours_; // of each piece; -1: none
};

} // namespace wct::geometry
