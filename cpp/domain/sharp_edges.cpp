#include "domain/sharp_edges.h"

#include "geometry/triangle_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace wct::domain {

namespace {

constexpr double kSharp = 1.0471975511965976; // 60 degrees

} // namespace

SharpEdges::SharpEdges(const Reference &reference, bool outside)
    : reference_(reference), curves_(reference.curves().size(), 0) {
    const auto &data = reference.data();
    const geometry::TriangleEdges edges(data.triangles);
    std::vector<geometry::Box> boxes;
    for (std::size_t s = 0; s < data.segments.size(); ++s) {
        const auto &[v, w] = data.segments[s];
        const std::span<const int> own = edges.owners(sorted(v, w));
        if (own.size() != 2 || data.sides[data.patch[own[0]]] != data.sides[data.patch[own[1]]])
            continue;
        const Vec3 &n = reference.normal(own[0]), &m = reference.normal(own[1]);
        int apex = -1;
        for (const int u : data.triangles[own[1]])
            if (u != v && u != w)
                apex = u;
        const bool ridge = dot(data.points[apex] - data.points[v], n) < 0.0;
        const double inside = std::numbers::pi - angle(n, m); // on the side where it is less than half a turn
        if (inside >= kSharp || inside <= 0.0 || (data.sides[data.patch[own[0]]][ridge ? 0 : 1] < 0) != outside)
            continue;
        edges_.push_back({{v, w}, {own[0], own[1]}, 2.0 * std::sin(0.5 * inside)});
        curves_[data.curve[s]] = 1;
        geometry::Box box;
        box.add(data.points[v]);
        box.add(data.points[w]);
        boxes.push_back(box);
    }
    tree_ = geometry::BoxTree(boxes);
}

SharpFoot SharpEdges::nearest(const Vec3 &p, double most) const {
    SharpFoot foot;
    const double square = tree_.minimise(
        most * most, [&](std::size_t node) { return tree_.box(node).square(p); },
        [&](std::size_t item, double best) {
            const SharpEdge &edge = edges_[item];
            const auto &points = reference_.data().points;
            const geometry::SegmentPoint at =
                geometry::nearest_on_segment(p, points[edge.ends[0]], points[edge.ends[1]]);
            if (at.square < best)
                foot = {at.point, static_cast<int>(item), at.along, 0.0};
            return at.square;
        });
    foot.distance = std::sqrt(square);
    return foot;
}

} // namespace wct::domain
