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

/// A facet at an edge: the direction in which it leaves it, as the angle round it from the first, and what lies behind
/// it that way.
struct Leaf {
    double turn;
    int triangle;
    int region;
    Vec3 away;
};

/// The facets round the edge from v to w, in the order in which a turn about it meets them.
std::vector<Leaf> leaves(const Reference &reference, int v, int w, std::span<const int> triangles) {
    const auto &data = reference.data();
    const Vec3 from = data.points[v], along = unit(data.points[w] - from);
    std::vector<Leaf> out;
    for (const int t : triangles) {
        Vec3 away;
        for (const int u : data.triangles[t])
            if (u != v && u != w)
                away = data.points[u] - from;
        away = unit(away - dot(away, along) * along);
        const Vec3 zero = out.empty() ? away : out[0].away;
        double turn = std::atan2(dot(cross(zero, away), along), dot(zero, away));
        if (turn < 0.0)
            turn += 2.0 * std::numbers::pi;
        const bool ahead = dot(cross(along, away), reference.normal(t)) > 0.0;
        out.push_back({turn, t, data.sides[data.patch[t]][ahead ? 1 : 0], away});
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
        const int segment = static_cast<int>(s);
        const std::span<const int> own = edges.owners(sorted(v, w));
        if (own.size() > 2)
            add_shared(segment, own, outside, boxes);
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
        add(segment, {{v, w}, {own[0], own[1]}, 2.0 * std::sin(0.5 * inside)}, boxes);
    }
    tree_ = geometry::BoxTree(boxes);
}

void SharpEdges::add_shared(int segment, std::span<const int> owners, bool outside, std::vector<geometry::Box> &boxes) {
    const auto &[v, w] = reference_.data().segments[segment];
    const std::vector<Leaf> round = leaves(reference_, v, w, owners);
    for (std::size_t k = 0; k < round.size(); ++k) {
        const Leaf &here = round[k], &next = round[(k + 1) % round.size()];
        const double wide = next.turn - here.turn + (k + 1 == round.size() ? 2.0 * std::numbers::pi : 0.0);
        if (wide < kSharp && wide > 0.0 && (here.region < 0) == outside)
            add(segment,
                {{v, w},
                 {here.triangle, next.triangle},
                 2.0 * std::sin(0.5 * wide),
                 true,
                 unit(here.away + next.away),
                 0.5 * wide},
                boxes);
    }
}

void SharpEdges::add(int segment, const SharpEdge &edge, std::vector<geometry::Box> &boxes) {
    edges_.push_back(edge);
    curves_[reference_.data().curve[segment]] = 1;
    geometry::Box box;
    for (const int v : edge.ends)
        box.add(reference_.data().points[v]);
    boxes.push_back(box);
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
