// The crease part of Reference: chains of edges, their curvature, their nearest points.
#include "domain/reference.h"

#include "geometry/triangle_edges.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace wct::domain {

void Reference::make_curves() {
    int count = 0;
    for (const int c : data_.curve)
        count = std::max(count, c + 1);
    std::vector<std::map<int, std::vector<int>>> around(count);
    for (std::size_t s = 0; s < data_.segments.size(); ++s) {
        const auto &[a, b] = data_.segments[s];
        around[data_.curve[s]][a].push_back(b);
        around[data_.curve[s]][b].push_back(a);
    }
    std::vector<char> corner(data_.points.size(), 0);
    for (const int v : data_.corners)
        corner[v] = 1;
    for (auto &next : around) {
        Curve curve;
        if (next.empty()) {
            curves_.push_back(curve);
            continue;
        }
        int start = next.begin()->first;
        for (const auto &[v, others] : next)
            if (corner[v] || others.size() != 2) {
                start = v;
                break;
            }
        curve.vertices.push_back(start);
        int before = -1;
        int at = start;
        while (true) {
            int to = -1;
            for (const int w : next[at])
                if (w != before) {
                    to = w;
                    break;
                }
            if (to < 0)
                break;
            if (to == start) {
                curve.closed = true;
                break;
            }
            curve.vertices.push_back(to);
            if (corner[to] || next[to].size() != 2)
                break;
            before = at;
            at = to;
        }
        if (curve.closed && corner[start]) { // a loop pinned at one corner starts and ends there
            curve.closed = false;
            curve.vertices.push_back(start);
        }
        bend_curve(curve);
        curves_.push_back(std::move(curve));
    }
    rebuild_curves();
    find_patches_around();
}

void Reference::find_patches_around() {
    const auto add = [](std::vector<int> &patches, int patch) { // in ascending order, each once
        const auto at = std::lower_bound(patches.begin(), patches.end(), patch);
        if (at == patches.end() || *at != patch)
            patches.insert(at, patch);
    };
    vertex_patches_.resize(data_.points.size());
    for (std::size_t t = 0; t < data_.triangles.size(); ++t)
        for (const int v : data_.triangles[t])
            add(vertex_patches_[v], data_.patch[t]);
    const geometry::TriangleEdges edges(data_.triangles);
    curve_patches_.resize(curves_.size());
    for (std::size_t s = 0; s < data_.segments.size(); ++s) {
        const auto &[v, w] = data_.segments[s];
        for (const int t : edges.owners(sorted(v, w)))
            add(curve_patches_[data_.curve[s]], data_.patch[t]);
    }
}

void Reference::bend_curve(Curve &curve) {
    const auto &points = data_.points;
    const int count = static_cast<int>(curve.vertices.size());
    curve.bend.assign(count, {});
    curve.shift.assign(count, {});
    const Vec3 &a = points[curve.vertices.front()];
    const Vec3 line = unit(points[curve.vertices.back()] - a);
    double extent = 0.0, off = 0.0;
    for (int k = 0; k < count; ++k) {
        const Vec3 d = points[curve.vertices[k]] - a;
        extent = std::max(extent, norm(d));
        off = std::max(off, norm(d - dot(d, line) * line));
        if (!curve.closed && (k == 0 || k == count - 1))
            continue;
        const Vec3 u = points[curve.vertices[k]] - points[curve.vertices[(k + count - 1) % count]];
        const Vec3 v = points[curve.vertices[(k + 1) % count]] - points[curve.vertices[k]];
        const double lu = norm(u);
        const double lv = norm(v);
        if (lu > 0.0 && lv > 0.0)
            curve.bend[k] = (2.0 / (lu + lv)) * ((1.0 / lv) * v - (1.0 / lu) * u);
    }
    curve.straight = !curve.closed && geometry::is_flat(off, extent, data_.flat);
    if (curve.straight) {
        curve.bend.assign(count, {});
        return;
    }
    for (int pass = 0; pass < 3; ++pass) {
        auto smooth = curve.bend;
        for (int k = 0; k < count; ++k)
            if (curve.closed || (k > 0 && k < count - 1))
                smooth[k] = 0.25 * curve.bend[(k + count - 1) % count] + 0.5 * curve.bend[k] +
                            0.25 * curve.bend[(k + 1) % count];
        curve.bend = smooth;
        if (!curve.closed && count > 2) {
            curve.bend.front() = curve.bend[1];
            curve.bend.back() = curve.bend[count - 2];
        }
    }
}

void Reference::rebuild_curves() {
    for (Curve &curve : curves_) {
        std::vector<geometry::Box> boxes;
        const int count = static_cast<int>(curve.vertices.size());
        for (int k = 0; k < curve.steps(); ++k) {
            geometry::Box box;
            for (const int end : {k, (k + 1) % count}) {
                box.add(data_.points[curve.vertices[end]]);
                box.add(data_.points[curve.vertices[end]] + curve.shift[end]);
            }
            boxes.push_back(box);
        }
        curve.tree = geometry::BoxTree(boxes);
    }
}

double Reference::length(int curve) const {
    const Curve &on = curves_[curve];
    double sum = 0.0;
    for (int k = 0; k < on.steps(); ++k)
        sum += norm(data_.points[on.at(k + 1)] - data_.points[on.at(k)]);
    return sum;
}

CurveFoot Reference::nearest_on_curve(const Vec3 &p, int which, bool shifted) const {
    const Curve &curve = curves_[which];
    const int count = static_cast<int>(curve.vertices.size());
    CurveFoot foot;
    const double square = curve.tree.minimise(
        std::numeric_limits<double>::infinity(), [&](std::size_t node) { return curve.tree.box(node).square(p); },
        [&](std::size_t item, double best) {
            const int k = static_cast<int>(item);
            const int l = (k + 1) % count;
            Vec3 a = data_.points[curve.vertices[k]];
            Vec3 b = data_.points[curve.vertices[l]];
            if (shifted) {
                a += curve.shift[k];
                b += curve.shift[l];
            }
            const geometry::SegmentPoint at = geometry::nearest_on_segment(p, a, b);
            if (at.square < best)
                foot = {at.point, unit(b - a), k, at.along, 0.0};
            return at.square;
        });
    foot.distance = std::sqrt(square);
    return foot;
}

Vec3 Reference::to_curve(Vec3 &p, int curve) const {
    const CurveFoot foot = nearest_on_curve(p, curve, true);
    if (foot.step >= 0)
        p = foot.point;
    return foot.tangent;
}

} // namespace wct::domain
