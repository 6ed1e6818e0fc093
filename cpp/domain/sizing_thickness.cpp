// The thickness part of Sizing: what walls, gaps and layers let edges be, by rays from the middles of triangles.
#include "domain/sizing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace wct::domain {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kParallelLayer = 0.98; // cosine between the sides of a layer: within 11 degrees
/// Size per thickness of a layer whose sides are parallel where longer edges are wanted. One row of tets goes through
/// it, as in the tiling of a slab (Walkington and VanderZee), whose edges are 1.35 to 1.8 thicknesses long.
constexpr double kLayer = 1.4;
/// The same for three rows, as of the body-centred lattice between four of its (110) planes: 1.05 cells in 3 / sqrt 2
/// of them. With sizes between that and one row, facets on one side must suit those on the other through the points of
/// one plane, and a third of the tets of such layers start bad at interfaces, where tets beyond hold their facets.
constexpr double kThreeRows = 0.495;
constexpr double kBroad = 12.0; // least area of its sides, in squares of the thickness
/// Least size allowed, in thicknesses, for that, and least size wanted at an interface, as rows have to suit what is
/// beyond. Of shorter edges two rows are better.
constexpr double kCoarse = 1.2, kCoarseInside = 1.8;
constexpr double kCone = 0.5235987755982988; // of the rays about the normal: 30 degrees
constexpr double kRoom = 1.0 + 1e-9;         // beyond what rays are to reach: rounding loses no hit

} // namespace

SharpFoot Sizing::closing(const SharpEdges &edges, const Vec3 &p, double width, double least) {
    constexpr double slack = 1.5;
    const SharpFoot foot = edges.nearest(p, slack * width / least);
    return foot.edge >= 0 && slack * width > edges.narrow(foot.edge) * foot.distance ? foot : SharpFoot{};
}

bool Sizing::notched(const Vec3 &p, double gap) const {
    const SharpFoot foot = closing(notches_, p, gap, kNarrowestNotch);
    return foot.edge >= 0 && notches_.narrow(foot.edge) > kNarrowestNotch;
}

bool Sizing::tapered(const Vec3 &p, double thickness) const {
    return closing(sharp_, p, thickness, 0.25).edge >= 0; // 14 degrees
}

Sizing::Row Sizing::row_at(int triangle, int side, double wanted) const {
    const auto &data = reference_.data();
    const int own = data.patch[triangle], between = data.sides[own][side];
    constexpr Row none{kInfinity, false};
    if (between < 0)
        return none;
    const auto &[a, b, c] = data.triangles[triangle];
    const Vec3 center = (1.0 / 3.0) * (data.points[a] + data.points[b] + data.points[c]);
    const Vec3 inward = (side == 0 ? -1.0 : 1.0) * reference_.normal(triangle);
    const double allowed = reference_.planar(own) ? wanted : std::min({wanted, curved_[a], curved_[b], curved_[c]});
    int hit = -1;
    const double far = reference_.ray(center, inward, reference_.ray_start(), kRoom * allowed / kCoarse, hit);
    if (hit < 0 || allowed < kCoarse * far || patch_area_[own] < kBroad * far * far)
        return none;
    const bool inner = reference_.inner(own) || reference_.inner(data.patch[hit]);
    if (inner && wanted < kCoarseInside * far)
        return none;
    // Facets of curved sides lie across each other, so smooth normals are compared. Those of interfaces and sheets run
    // either way: what counts is which side the layer is on.
    const Vec3 here = reference_.smooth_normal(reference_.nearest(center, own, triangle));
    const Vec3 there = reference_.smooth_normal(reference_.nearest(center + far * inward, data.patch[hit], hit));
    const auto &[behind, before] = data.sides[data.patch[hit]];
    const double along = (side == 0 ? -1.0 : 1.0) * dot(here, there);
    const double outward = behind == before ? std::fabs(along) : behind == between ? along : -along;
    return outward > kParallelLayer ? Row{far, inner} : none;
}

Sizing::Thickness Sizing::thickness_at(int triangle, double wanted, double reach) const {
    // Sheets: rays to either side, in a cone, that hit a triangle facing the other way.
    constexpr int kRays = 9;
    constexpr int kRank = 3;          // of the hits by distance, that counts: a few may stray
    constexpr double kFacing = 0.5;   // cosine between normals of triangles that face each other, either way round
    constexpr double kTurned = 0.1;   // of the cone about the normal: rays along edges tell little
    constexpr double kParallel = 0.8; // the same of a wall's sides
    const auto &data = reference_.data();
    const Vec3 &n = reference_.normal(triangle);
    const auto &[a, b, c] = data.triangles[triangle];
    const Vec3 center = (1.0 / 3.0) * (data.points[a] + data.points[b] + data.points[c]);
    const Vec3 u = across(n);
    const Vec3 v = cross(n, u);
    const int own = data.patch[triangle];
    Thickness thickness{kInfinity, {kInfinity, kInfinity}, {kInfinity, kInfinity}, kInfinity, false};
    for (int side = 0; side < 2; ++side) {
        // Across a gap outside no tets are wanted: facets only must be too small to reach over.
        const bool outside = data.sides[own][side] < 0;
        std::array<double, kRays> hits, walls;
        for (int j = 0; j < kRays; ++j) {
            const double tilt = j == 0 ? 0.0 : kCone;
            const double turn = 2.0 * std::numbers::pi * j / (kRays - 1) + kTurned;
            const Vec3 inward = (side == 0 ? -1.0 : 1.0) * n;
            const Vec3 d = std::cos(tilt) * inward + std::sin(tilt) * (std::cos(turn) * u + std::sin(turn) * v);
            int hit = -1;
            const double far = reference_.ray(center, d, reference_.ray_start(), reach, hit);
            // An interface's normal may point either way: a ray through a region meets what bounds it from within.
            const double along = hit < 0 ? 0.0 : std::fabs(dot(reference_.normal(hit), n));
            const bool opposite = along > kFacing && !(outside && notched(center, far));
            hits[j] = opposite ? far * std::cos(tilt) : kInfinity;
            const bool is_wall = along > kParallel && (reference_.planar(own) ||
                                                       !(reference_.inner(own) || reference_.inner(data.patch[hit])));
            walls[j] = opposite && is_wall ? hits[j] : kInfinity;
        }
        std::nth_element(hits.begin(), hits.begin() + kRank, hits.end());
        std::nth_element(walls.begin(), walls.begin() + kRank, walls.end());
        const double tolerance = std::min({form_.tolerance_at(a), form_.tolerance_at(b), form_.tolerance_at(c)});
        const double narrow = form_.gap * std::max(hits[kRank], form_.narrowest * tolerance);
        const Row row = row_at(triangle, side, wanted);
        const bool three = row.inner && !form_.one_row;
        const double inside =
            row.thickness < kInfinity ? (three ? kThreeRows : kLayer) * row.thickness : form_.thickness * hits[kRank];
        const double limit = outside ? narrow : inside;
        thickness.layer = std::min(thickness.layer, three ? kInfinity : row.thickness);
        thickness.row = thickness.row || row.inner;
        thickness.limit = std::min(thickness.limit, limit);
        if (!outside) {
            thickness.wall[side] = walls[kRank];
            thickness.apart[side] = hits[kRank];
        }
    }
    thickness.limit = std::min(thickness.limit, reference_.diagonal());
    return thickness;
}

void Sizing::limit_to_mean(const std::vector<double> &thin, const std::vector<char> &measured) {
    const auto &data = reference_.data();
    std::vector<double> sum(data.points.size(), 0.0);
    std::vector<double> weight(data.points.size(), 0.0);
    for (std::size_t t = 0; t < thin.size(); ++t)
        if (measured[t])
            for (const int at : data.triangles[t]) {
                sum[at] += reference_.area(static_cast<int>(t)) * thin[t];
                weight[at] += reference_.area(static_cast<int>(t));
            }
    for (std::size_t v = 0; v < sum.size(); ++v)
        if (weight[v] > 0.0)
            limit_[v] = std::min(limit_[v], sum[v] / weight[v]);
}

void Sizing::limit_by_thickness(const Workers &workers) {
    const auto &data = reference_.data();
    std::vector<double> thin(data.triangles.size()), layers(data.triangles.size(), kInfinity);
    std::vector<char> measured(data.triangles.size(), 0), rows(data.triangles.size(), 0);
    wall_.assign(data.triangles.size(), {kInfinity, kInfinity});
    apart_.assign(data.triangles.size(), {kInfinity, kInfinity});
    patch_area_.assign(data.sides.size(), 0.0);
    for (std::size_t t = 0; t < data.triangles.size(); ++t)
        patch_area_[data.patch[t]] += reference_.area(static_cast<int>(t));
    const auto size_at = [&](std::size_t t) {
        const auto &[a, b, c] = data.triangles[t];
        return std::max({limit_[a], limit_[b], limit_[c]});
    };
    // Rays end where what they hit allows longer edges than are wanted anyway.
    const double room = kRoom / std::cos(kCone), most = std::max(1.0 / form_.thickness, 1.0 / form_.gap);
    const double far = room * std::max(most, kThick), far_bent = room * std::max(most, kThickBent);
    workers.for_each(thin.size(), 64, [&](std::size_t t) {
        const auto &[a, b, c] = data.triangles[t];
        const Vec3 center = (1.0 / 3.0) * (data.points[a] + data.points[b] + data.points[c]);
        const double size = size_at(t);
        measured[t] = !(reference_.normal(static_cast<int>(t)) == Vec3{}) && sharp_.nearest(center, size).edge < 0;
        if (measured[t]) {
            const bool bent = bent_inside(static_cast<int>(t));
            const Thickness here = thickness_at(static_cast<int>(t), size, (bent ? far_bent : far) * size);
            layers[t] = here.layer;
            rows[t] = here.row;
            thin[t] = here.limit;
            apart_[t] = here.apart;
            for (int side = 0; side < 2; ++side)
                if (here.wall[side] < kInfinity && !tapered(center, here.wall[side]))
                    wall_[t][side] = here.wall[side];
        }
    });
    // Where the mean at a point counts, as some triangle there allows less than is wanted, so do those that allow more.
    std::vector<char> limited(data.points.size(), 0);
    for (std::size_t t = 0; t < thin.size(); ++t)
        for (const int at : data.triangles[t])
            if (measured[t] && thin[t] < limit_[at])
                limited[at] = 1;
    workers.for_each(thin.size(), 64, [&](std::size_t t) {
        const auto &[a, b, c] = data.triangles[t];
        if (measured[t] && thin[t] >= size_at(t) && (limited[a] || limited[b] || limited[c]))
            thin[t] = thickness_at(static_cast<int>(t), size_at(t), kInfinity).limit;
    });
    has_rows_ = std::find(rows.begin(), rows.end(), 1) != rows.end();
    layer_.assign(data.points.size(), 0.0);
    for (std::size_t t = 0; t < layers.size(); ++t)
        if (layers[t] < kInfinity)
            for (const int at : data.triangles[t])
                layer_[at] = std::max(layer_[at], layers[t]);
    limit_to_mean(thin, measured);
    // Where a layer's interface ends, the mean is that of the walls beside the layer, which are long.
    for (std::size_t t = 0; t < data.triangles.size(); ++t) {
        if (!reference_.inner(data.patch[t]) || reference_.sheet(data.patch[t]))
            continue;
        for (const int at : data.triangles[t])
            if (layer_[at] > 0.0)
                limit_[at] = std::min(limit_[at], kLayer * layer_[at]);
    }
}

} // namespace wct::domain
