#include "surface_guide.h"

#include <algorithm>

namespace wct {

namespace {
constexpr double kFlat = 1e-9; // of the patch's extent: what counts as planar or straight

/// Where a facet is held against the surface: centroid, edges at quarters, and inner points.
constexpr double kWeights[SurfaceGuide::kSamples][3] = {{1. / 3, 1. / 3, 1. / 3},
                                                        {.5, .5, 0},
                                                        {0, .5, .5},
                                                        {.5, 0, .5},
                                                        {.5, .25, .25},
                                                        {.25, .5, .25},
                                                        {.25, .25, .5},
                                                        {.75, .25, 0},
                                                        {.25, .75, 0},
                                                        {0, .75, .25},
                                                        {0, .25, .75},
                                                        {.75, 0, .25},
                                                        {.25, 0, .75}};

Vec3 blend(const double weights[3], const Vec3 &p, const Vec3 &q, const Vec3 &r) {
    return weights[0] * p + weights[1] * q + weights[2] * r;
}

Vec3 unit(const Vec3 &v) {
    const double length = norm(v);
    return length > 0.0 ? (1.0 / length) * v : Vec3{};
}
} // namespace

SurfaceGuide::SurfaceGuide(const std::vector<Vec3> &points, const std::vector<Facet> &triangles,
                           const std::vector<int> &patch, const std::vector<Edge> &segments,
                           const std::vector<int> &curve, double tolerance, double shell)
    : tolerance_(tolerance), shell_(shell) {
    const int patches = patch.empty() ? 0 : *std::max_element(patch.begin(), patch.end()) + 1;
    const int curves = curve.empty() ? 0 : *std::max_element(curve.begin(), curve.end()) + 1;
    std::vector<std::vector<Facet>> of_patch(patches);
    for (std::size_t k = 0; k < triangles.size(); ++k)
        of_patch[patch[k]].push_back(triangles[k]);
    for (const auto &members : of_patch) {
        std::vector<std::array<Vec3, 3>> pieces;
        for (const Facet &f : members)
            pieces.push_back({points[f[0]], points[f[1]], points[f[2]]});
        Patch one{BoundingTree<3>(std::move(pieces)), false, {}, {}};
        // The largest triangle's plane is the best conditioned one; interfaces may wind either way, so not the sum.
        double largest = -1.0, extent = 0.0, off = 0.0;
        for (const Facet &f : members) {
            const Vec3 n = cross(points[f[1]] - points[f[0]], points[f[2]] - points[f[0]]);
            if (norm(n) > largest) {
                largest = norm(n);
                one.normal = unit(n);
                one.origin = points[f[0]];
            }
        }
        for (const Facet &f : members)
            for (int v : f) {
                extent = std::max(extent, norm(points[v] - one.origin));
                off = std::max(off, std::abs(dot(points[v] - one.origin, one.normal)));
            }
        one.planar = !members.empty() && off <= kFlat * extent;
        patches_.push_back(std::move(one));
    }
    std::vector<std::vector<Edge>> of_curve(curves);
    for (std::size_t k = 0; k < segments.size(); ++k)
        of_curve[curve[k]].push_back(segments[k]);
    for (const auto &members : of_curve) {
        std::vector<std::array<Vec3, 2>> pieces;
        for (const Edge &s : members)
            pieces.push_back({points[s[0]], points[s[1]]});
        Curve one{BoundingTree<2>(std::move(pieces)), false, {}, {}};
        Vec3 far = {};
        double extent = 0.0, off = 0.0;
        if (!members.empty())
            one.origin = points[members[0][0]];
        for (const Edge &s : members)
            for (int v : s)
                if (norm(points[v] - one.origin) > extent) {
                    far = points[v] - one.origin;
                    extent = norm(far);
                }
        one.direction = unit(far);
        for (const Edge &s : members)
            for (int v : s)
                off = std::max(off, norm(cross(points[v] - one.origin, one.direction)));
        one.straight = extent > 0.0 && off <= kFlat * extent;
        curves_.push_back(std::move(one));
    }
}

bool SurfaceGuide::admit(const Vertex &vertex, Vec3 &x, Vec3 *direction) const {
    if (direction)
        *direction = {};
    const auto within_shell = [&](const Vec3 &foot) {
        const Vec3 off = x - foot;
        const double length = norm(off);
        if (length > shell_)
            x = foot + (shell_ / length) * off;
    };
    switch (vertex.stratum) {
    case Stratum::interior:
        return true;
    case Stratum::patch: {
        const Patch &patch = patches_[vertex.label];
        if (patch.planar) {
            x -= dot(x - patch.origin, patch.normal) * patch.normal;
            if (direction)
                *direction = patch.normal;
            return true;
        }
        within_shell(patch.tree.closest(x).point);
        return true;
    }
    case Stratum::crease: {
        const Curve &curve = curves_[vertex.label];
        if (curve.straight) {
            x = curve.origin + dot(x - curve.origin, curve.direction) * curve.direction;
            if (direction)
                *direction = curve.direction;
            return true;
        }
        const auto hit = curve.tree.closest(x);
        const auto &ends = curve.tree.pieces()[hit.piece];
        x = hit.point;
        if (direction)
            *direction = unit(ends[1] - ends[0]);
        return true;
    }
    case Stratum::corner:
        break;
    }
    return false;
}

bool SurfaceGuide::allows(int patch, const Vec3 &p, const Vec3 &q, const Vec3 &r) const {
    Hints hints;
    hints.fill(0);
    return within(patch, p, q, r, tolerance_, hints);
}

bool SurfaceGuide::within(int patch, const Vec3 &p, const Vec3 &q, const Vec3 &r, double limit, Hints &hints) const {
    const Patch &guide = patches_[patch];
    if (guide.planar)
        return true;
    const Vec3 n = cross(q - p, r - p);
    for (int k = 0; k < kSamples; ++k) {
        const Vec3 x = blend(kWeights[k], p, q, r);
        const std::int32_t near = guide.tree.within(x, limit * limit, hints[k]);
        if (near < 0)
            return false;
        hints[k] = near;
        if (k == 0) {
            const auto &c = guide.tree.pieces()[hints[k]];
            const Vec3 m = cross(c[1] - c[0], c[2] - c[0]);
            if (std::abs(dot(n, m)) < 0.6 * norm(n) * norm(m))
                return false;
        }
    }
    return true;
}

double SurfaceGuide::deviation(int patch, const Vec3 &p, const Vec3 &q, const Vec3 &r) const {
    const Patch &guide = patches_[patch];
    double worst = 0.0;
    if (!guide.planar)
        for (const auto &weights : kWeights)
            worst = std::max(worst, norm(guide.tree.closest(blend(weights, p, q, r)).point - blend(weights, p, q, r)));
    return worst;
}

bool SurfaceGuide::allows_crease(int curve, const Vec3 &p, const Vec3 &q) const {
    const Curve &guide = curves_[curve];
    if (guide.straight)
        return true;
    for (double t : {0.25, 0.5, 0.75})
        if (guide.tree.within((1.0 - t) * p + t * q, tolerance_ * tolerance_, 0) < 0)
            return false;
    return true;
}

} // namespace wct
