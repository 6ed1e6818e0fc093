#pragma once

#include "base/vec3.h"
#include "geometry/closest_point.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

namespace wct::geometry {

struct Box {
    Vec3 lo{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
            std::numeric_limits<double>::infinity()};
    Vec3 hi{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
            -std::numeric_limits<double>::infinity()};

    void add(const Vec3 &p) {
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
    void add(const Box &b) {
        add(b.lo);
        add(b.hi);
    }
    Vec3 center() const { return 0.5 * (lo + hi); }
    double diagonal() const { return norm(hi - lo); }
    bool contains(const Vec3 &p) const {
        return p.x >= lo.x && p.x <= hi.x && p.y >= lo.y && p.y <= hi.y && p.z >= lo.z && p.z <= hi.z;
    }
    /// Squared distance of a point to the box, 0 inside.
    double square(const Vec3 &p) const { return square({p, p}); }
    /// The same of another box.
    double square(const Box &b) const {
        // Two by two: of a list, compilers make branches.
        const double x = std::max(0.0, std::max(lo.x - b.hi.x, b.lo.x - hi.x));
        const double y = std::max(0.0, std::max(lo.y - b.hi.y, b.lo.y - hi.y));
        const double z = std::max(0.0, std::max(lo.z - b.hi.z, b.lo.z - hi.z));
        return x * x + y * y + z * z;
    }
};

/// The axis along which a vector is longest, the first of equal ones.
inline double Vec3::*longest_axis(const Vec3 &v) {
    return v.x >= v.y && v.x >= v.z ? &Vec3::x : v.y >= v.z ? &Vec3::y : &Vec3::z;
}

/// A bounding-volume tree over boxes. It knows no geometry: the callers measure their own items.
class BoxTree {
  public:
    BoxTree() = default;
    /// Items are halved by the centers of their boxes.
    explicit BoxTree(std::span<const Box> boxes);
    /// `halve(box, items, middle)` puts those first, up to `middle`, that are to be in the same half; `box` is round
    /// all of the items.
    template <class Halve> BoxTree(std::span<const Box> boxes, const Halve &halve) : items_(boxes.size()) {
        std::iota(items_.begin(), items_.end(), 0);
        nodes_.reserve(boxes.size());
        if (!boxes.empty())
            build(boxes, 0, static_cast<std::int32_t>(boxes.size()), halve);
    }
    /// The items in the order of the leaves; from here on an item is named by its place in it.
    std::vector<std::int32_t> renumber();

    bool empty() const { return nodes_.empty(); }
    std::size_t nodes() const { return nodes_.size(); }
    const Box &box(std::size_t node) const { return nodes_[node].box; }

    /// The smallest `value(item)` that is below `best`. `bound(node)` must be at most the value of every item below
    /// that node. Ties go to the item visited first, so the answer does not depend on anything but the input.
    template <class Bound, class Value> double minimise(double best, const Bound &bound, const Value &value) const {
        if (nodes_.empty())
            return best;
        struct Entry {
            double bound;
            std::int32_t node;
        };
        std::array<Entry, kDepth> stack;
        std::size_t top = 0;
        stack[top++] = {bound(std::size_t{0}), 0};
        while (top) {
            const Entry entry = stack[--top];
            if (!(entry.bound < best))
                continue;
            const Node &node = nodes_[static_cast<std::size_t>(entry.node)];
            if (node.right < 0) {
                for (std::int32_t i = node.first; i < node.last; ++i)
                    best = std::min(best, value(static_cast<std::size_t>(items_[static_cast<std::size_t>(i)]), best));
                continue;
            }
            const Entry left{bound(static_cast<std::size_t>(entry.node) + 1), entry.node + 1};
            const Entry right{bound(static_cast<std::size_t>(node.right)), node.right};
            const bool swap = right.bound < left.bound;
            stack[top++] = swap ? left : right;
            stack[top++] = swap ? right : left;
        }
        return best;
    }

    /// Visit the items of every leaf whose path of boxes `inside(box)` accepts, until `visit(item)` returns true.
    template <class Inside, class Visit> bool visit(const Inside &inside, const Visit &visit) const {
        if (nodes_.empty())
            return false;
        std::array<std::int32_t, kDepth> stack;
        std::size_t top = 0;
        stack[top++] = 0;
        while (top) {
            const std::int32_t at = stack[--top];
            const Node &node = nodes_[static_cast<std::size_t>(at)];
            if (!inside(node.box))
                continue;
            if (node.right < 0) {
                for (std::int32_t i = node.first; i < node.last; ++i)
                    if (visit(static_cast<std::size_t>(items_[static_cast<std::size_t>(i)])))
                        return true;
                continue;
            }
            stack[top++] = node.right;
            stack[top++] = at + 1;
        }
        return false;
    }

    /// Per node the smallest of the items' values below it.
    std::vector<double> smallest(std::span<const double> values) const;

  private:
    /// Median splits keep the depth near log2(n / 4): 128 entries outlast any input that fits memory.
    static constexpr std::size_t kDepth = 128;
    static constexpr std::int32_t kLeaf = 4;
    struct Node {
        Box box;
        std::int32_t first = 0;
        std::int32_t last = 0;
        std::int32_t right = -1; // the left child follows its parent; -1 marks a leaf
    };
    template <class Halve>
    std::int32_t build(std::span<const Box> boxes, std::int32_t first, std::int32_t last, const Halve &halve) {
        const auto id = static_cast<std::int32_t>(nodes_.size());
        Box box;
        for (std::int32_t i = first; i < last; ++i)
            box.add(boxes[static_cast<std::size_t>(items_[static_cast<std::size_t>(i)])]);
        nodes_.push_back({box, first, last, -1});
        if (last - first > kLeaf) {
            const std::int32_t half = (last - first) / 2;
            halve(box,
                  std::span(items_).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first)),
                  static_cast<std::size_t>(half));
            build(boxes, first, first + half, halve);
            const std::int32_t right = build(boxes, first + half, last, halve);
            nodes_[static_cast<std::size_t>(id)].right = right;
        }
        return id;
    }

    std::vector<Node> nodes_;
    std::vector<std::int32_t> items_;
};

/// A squared distance a hair above this one, which rounding cannot carry a nearer point across. `scale`: the largest
/// coordinate.
double with_room(double square, double scale);

/// Distance along the ray p + t d, t > least, to the triangle; infinity if it misses.
double ray_triangle(const Vec3 &p, const Vec3 &d, double least, const Vec3 &a, const Vec3 &b, const Vec3 &c);

/// 1/d per axis, for ray_box: infinity of one sign where d is 0.
inline Vec3 inverse_of(const Vec3 &d) {
    return {1.0 / (d.x + 0.0), 1.0 / (d.y + 0.0), 1.0 / (d.z + 0.0)}; // -0 + 0 is 0
}

/// Least t >= 0 at which p + t d is in the box, infinity if it never is. `inverse` as of inverse_of(d).
double ray_box(const Vec3 &p, const Vec3 &inverse, const Box &box);

} // namespace wct::geometry
