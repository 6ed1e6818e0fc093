#include "surface_fit.h"

#include <algorithm>
#include <cmath>

namespace wct {

namespace {

/// Samples of a facet besides its edges: the corners' own third and the middle.
constexpr double kInner[4][3] = {{1. / 3, 1. / 3, 1. / 3}, {.5, .25, .25}, {.25, .5, .25}, {.25, .25, .5}};

constexpr int kSteps = 6; // along an edge: where it crosses a bend of the reference, it is off most

Vec3 blend(const Cloud &cloud, const Tie &tie) {
    return tie.weight[0] * cloud.points[tie.corner[0]] + tie.weight[1] * cloud.points[tie.corner[1]] +
           tie.weight[2] * cloud.points[tie.corner[2]];
}

} // namespace

std::vector<Tie> tie_surface(const Cloud &cloud, const Complex &complex, const Reference &reference) {
    const auto &data = reference.data();
    const std::vector<std::array<int, 3>> facets = surface_facets(complex);
    std::vector<Box> boxes;
    for (const auto &facet : facets) {
        Box box;
        for (const int v : facet)
            box.add(cloud.points[v]);
        boxes.push_back(box);
    }
    const BoxTree tree(boxes);
    std::vector<Tie> ties;
    int hint = 0;
    const auto tie_point = [&](const std::array<int, 3> &facet, const std::array<double, 3> &weight) {
        Tie tie{facet, weight, {}, 0.0};
        const Vec3 p = blend(cloud, tie);
        const Foot foot = reference.nearest_from(p, hint);
        hint = foot.triangle;
        if (reference.planar(data.patch[foot.triangle]))
            return;
        // Across an edge of the reference the distance grows along the way to the foot; on it, along the normal.
        const Vec3 away = p - foot.point;
        tie.normal = foot.distance > 1e-9 * reference.diagonal() ? (1.0 / foot.distance) * away
                                                                 : reference.normal(foot.triangle);
        tie.level = dot(tie.normal, foot.point);
        ties.push_back(tie);
    };
    for (const auto &f : facets) {
        for (const auto &w : kInner)
            tie_point(f, {w[0], w[1], w[2]});
        for (int k = 0; k < 3; ++k) { // each edge from one of its two sides
            const int v = f[k];
            const int w = f[(k + 1) % 3];
            if (v > w)
                continue;
            for (int j = 1; j < kSteps; ++j) {
                std::array<double, 3> weight{};
                weight[k] = 1.0 - static_cast<double>(j) / kSteps;
                weight[(k + 1) % 3] = static_cast<double>(j) / kSteps;
                tie_point(f, weight);
            }
        }
    }
    for (std::size_t v = 0; v < data.points.size(); ++v) {
        const auto &patches = reference.patches_at_vertex(static_cast<int>(v));
        if (std::all_of(patches.begin(), patches.end(), [&](int p) { return reference.planar(p); }))
            continue;
        const Vec3 &p = data.points[v];
        Tie tie;
        Vec3 foot;
        const double square = tree.minimise(
            std::numeric_limits<double>::infinity(), [&](std::size_t node) { return tree.box(node).square(p); },
            [&](std::size_t item, double best) {
                const auto &f = facets[item];
                const TrianglePoint at =
                    nearest_on_triangle(p, cloud.points[f[0]], cloud.points[f[1]], cloud.points[f[2]]);
                if (at.square < best) {
                    tie.corner = f;
                    std::copy(at.weight, at.weight + 3, tie.weight.begin());
                    foot = at.point;
                }
                return at.square;
            });
        const double distance = std::sqrt(square);
        if (!(distance > 1e-9 * reference.diagonal()))
            continue;
        tie.normal = (1.0 / distance) * (foot - p);
        tie.level = dot(tie.normal, p);
        ties.push_back(tie);
    }
    return ties;
}

void fit_heights(Cloud &cloud, const Reference &reference, const std::vector<Tie> &ties,
                 const std::vector<Vec3> &direction, const FitForm &form) {
    constexpr int kSweeps = 10;
    struct Use {
        int tie;
        double slope; // of the tie's height when the point rises
    };
    std::vector<double> height;
    for (const Tie &tie : ties)
        height.push_back(dot(tie.normal, blend(cloud, tie)) - tie.level);
    std::vector<std::size_t> first(cloud.count() + 1, 0);
    for (const Tie &tie : ties)
        for (const int v : tie.corner)
            ++first[v + 1];
    for (std::size_t v = 0; v < cloud.count(); ++v)
        first[v + 1] += first[v];
    std::vector<Use> uses(first.back());
    auto next = first;
    for (std::size_t t = 0; t < ties.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const int v = ties[t].corner[k];
            uses[next[v]++] = {static_cast<int>(t), ties[t].weight[k] * dot(ties[t].normal, direction[v])};
        }
    struct Riser {
        int point;
        double at;     // height over the patch
        double wanted; // the offset there
    };
    std::vector<Riser> risers;
    for (std::size_t v = 0; v < cloud.count(); ++v) {
        if (cloud.role[v] != Stratum::patch || reference.planar(cloud.label[v]) || first[v] == first[v + 1])
            continue;
        Vec3 base = cloud.points[v];
        const Foot foot = reference.nearest(base, cloud.label[v]);
        reference.to_patch(base, cloud.label[v]);
        risers.push_back({static_cast<int>(v), dot(cloud.points[v] - foot.point, direction[v]),
                          dot(base - foot.point, direction[v])});
    }
    const double scale = 1.0 / form.limit;
    for (int sweep = 0; sweep < kSweeps; ++sweep)
        for (Riser &r : risers) {
            double slope = form.pull * (r.at - r.wanted) * scale;
            double bend = form.pull * scale;
            for (std::size_t k = first[r.point]; k < first[r.point + 1]; ++k) {
                const double h = height[uses[k].tie];
                const double over = std::fabs(h) * scale - 1.0;
                if (over <= 0.0)
                    continue;
                slope += std::copysign(over, h) * uses[k].slope;
                bend += scale * uses[k].slope * uses[k].slope;
            }
            const double to = std::clamp(r.at - slope / bend, -form.shell, form.shell);
            const double rise = to - r.at;
            r.at = to;
            cloud.points[r.point] += rise * direction[r.point];
            for (std::size_t k = first[r.point]; k < first[r.point + 1]; ++k)
                height[uses[k].tie] += rise * uses[k].slope;
        }
}

std::size_t count_off(const Cloud &cloud, const std::vector<Tie> &ties, double limit) {
    std::vector<std::array<int, 3>> off;
    for (const Tie &tie : ties)
        if (std::fabs(dot(tie.normal, blend(cloud, tie)) - tie.level) > limit)
            off.push_back(tie.corner);
    std::sort(off.begin(), off.end());
    return static_cast<std::size_t>(std::unique(off.begin(), off.end()) - off.begin());
}

} // namespace wct
