#include "domain/sharp_edges.h"

#include "geometry/triangle_edges.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <tuple>

namespace wct::domain {

namespace {

constexpr double kSharp = 1.0471975511965976; // 60 degrees

/// A facet at an edge: the direction in which it leaves it, as the angle round it from the first, what a turn on from
/// there comes to, and its normal away from that.
struct Leaf {
    double turn;
    int triangle;
    int region;
    Vec3 away, normal;
};

/// The facets round the edge from v to w, in the order in which a turn about it meets them.
std::vector<Leaf> leaves(const Reference &reference, int v, int w, std::span<const int> triangles) {
    const auto &data = reference.data();
    const Vec3 along = unit(data.points[w] - data.points[v]);
    std::vector<Leaf> out;
    for (const int t : triangles) {
        const Vec3 away = reference.away(t, {v, w}, along);
        const Vec3 zero = out.empty() ? away : out[0].away;
        double turn = std::atan2(dot(cross(zero, away), along), dot(zero, away));
        if (turn < 0.0)
            turn += 2.0 * std::numbers::pi;
        const Vec3 &normal = reference.normal(t);
        const bool ahead = dot(cross(along, away), normal) > 0.0;
        const auto &[behind, before] = reference.sides(data.patch[t]);
        out.push_back({turn, t, ahead ? before : behind, away, (ahead ? -1.0 : 1.0) * normal});
    }
    std::sort(out.begin(), out.end(),
              [](const Leaf &a, const Leaf &b) { return std::tie(a.turn, a.triangle) < std::tie(b.turn, b.triangle); });
    return out;
}

} // namespace

SharpEdges::SharpEdges(const Reference &reference, bool outside)
    : reference_(reference), curves_(reference.curves().size(), 0) {
    const auto &data = reference.data();
    const geometry::TriangleEdges edges(data.triangles);
    std::vector<geometry::Box> boxes;
    for (std::size_t s = 0; s < data.segments.size(); ++s) {
        const auto &[v, w] = data.segments[s];
        const std::vector<Leaf> round = leaves(reference, v, w, edges.owners(sorted(v, w)));
        for (std::size_t k = 0; round.size() > 1 && k < round.size(); ++k) {
            const bool last = k + 1 == round.size();
            const Leaf &here = round[k], &next = round[last ? 0 : k + 1];
            const double turn = next.turn - here.turn + (last ? 2.0 * std::numbers::pi : 0.0);
            const double wide = std::numbers::pi - angle(here.normal, -1.0 * next.normal);
            if (turn >= std::numbers::pi || wide >= kSharp || wide <= 0.0 || (here.region < 0) != outside)
                continue;
            edges_.push_back({{v, w},
                              {here.triangle, next.triangle},
                              2.0 * std::sin(0.5 * wide),
                              round.size() > 2,
                              unit(here.away + next.away),
                              0.5 * wide});
            curves_[data.curve[s]] = 1;
            geometry::Box box;
            box.add(data.points[v]);
            box.add(data.points[w]);
            boxes.push_back(box);
        }
    }
    tree_ = geometry::BoxTree(boxes);
}

bool SharpEdges::takes_in(const SharpFoot &foot, const Vec3 &p) const {
    constexpr double slack = 0.05; // radians, for points on its sides
    const SharpEdge &edge = edges_[foot.edge];
    return !edge.shared || angle(p - foot.point, edge.middle) <= edge.half + slack;
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
