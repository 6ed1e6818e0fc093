#include "geometry/box_tree.h"

#include <cmath>

namespace wct::geometry {

namespace {

double along(const Vec3 &v, int axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

} // namespace

BoxTree::BoxTree(std::span<const Box> boxes)
    : BoxTree(boxes, [boxes](const Box &, std::span<std::int32_t> items, std::size_t middle) {
          const auto center = [boxes](std::int32_t item) { return boxes[static_cast<std::size_t>(item)].center(); };
          Box centers;
          for (const std::int32_t item : items)
              centers.add(center(item));
          double Vec3::*const axis = longest_axis(centers.hi - centers.lo);
          std::nth_element(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(middle), items.end(),
                           [&](std::int32_t i, std::int32_t j) {
                               const double x = center(i).*axis, y = center(j).*axis;
                               return x != y ? x < y : i < j;
                           });
      }) {}

std::vector<std::int32_t> BoxTree::renumber() {
    std::vector<std::int32_t> order = items_;
    std::iota(items_.begin(), items_.end(), 0);
    return order;
}

std::vector<double> BoxTree::smallest(std::span<const double> values) const {
    std::vector<double> out(nodes_.size());
    for (std::size_t k = nodes_.size(); k-- > 0;) {
        const Node &node = nodes_[k];
        if (node.right < 0) {
            double least = std::numeric_limits<double>::infinity();
            for (std::int32_t i = node.first; i < node.last; ++i)
                least = std::min(least, values[static_cast<std::size_t>(items_[static_cast<std::size_t>(i)])]);
            out[k] = least;
        } else {
            out[k] = std::min(out[k + 1], out[static_cast<std::size_t>(node.right)]);
        }
    }
    return out;
}

double with_room(double square, double scale) {
    const double far = std::sqrt(square);
    const double above = far + 1e-14 * (far + scale);
    return std::max(above * above, std::numeric_limits<double>::min()); // what underflows must stay above a hit of 0
}

double ray_triangle(const Vec3 &p, const Vec3 &d, double least, const Vec3 &a, const Vec3 &b, const Vec3 &c) {
    constexpr double kMiss = std::numeric_limits<double>::infinity();
    constexpr double kSlack = 1e-9; // a ray through an edge must not slip between its two triangles
    const Vec3 e1 = b - a;
    const Vec3 e2 = c - a;
    const Vec3 h = cross(d, e2);
    const double det = dot(e1, h);
    if (det == 0.0)
        return kMiss;
    const Vec3 s = p - a;
    const double u = dot(s, h) / det;
    if (u < -kSlack || u > 1.0 + kSlack)
        return kMiss;
    const Vec3 q = cross(s, e1);
    const double v = dot(d, q) / det;
    if (v < -kSlack || u + v > 1.0 + kSlack)
        return kMiss;
    const double t = dot(e2, q) / det;
    return t > least ? t : kMiss;
}

double ray_box(const Vec3 &p, const Vec3 &inverse, const Box &box) {
    double near = 0.0;
    double far = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        double u = (along(box.lo, axis) - along(p, axis)) * along(inverse, axis);
        double v = (along(box.hi, axis) - along(p, axis)) * along(inverse, axis);
        if (u > v)
            std::swap(u, v);
        near = std::max(near, u); // a NaN (0 * infinity, the ray in a face's plane) leaves near and far as they are
        far = std::min(far, v);
    }
    return near <= far ? near : std::numeric_limits<double>::infinity();
}

} // namespace wct::geometry
