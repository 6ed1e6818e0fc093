#include "surface_fit.h"

#include "triangle_tree.h"

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

/// Ties of one facet's samples to the reference, nothing for those over planes.
void tie_facet(const Cloud &cloud, const Reference &reference, const std::array<int, 3> &f, std::vector<Tie> &ties) {
    int near = std::max({cloud.near[f[0]], cloud.near[f[1]], cloud.near[f[2]]});
    const auto tie_point = [&](const std::array<double, 3> &weight) {
        Tie tie{f, weight, {}, 0.0};
        const Vec3 p = blend(cloud, tie);
        const Foot foot = reference.nearest(p, -1, near);
        near = foot.triangle;
        if (reference.planar(reference.data().patch[foot.triangle]))
            return;
        // Across an edge of the reference the distance grows along the way to the foot; on it, along the normal.
        const Vec3 away = p - foot.point;
        tie.normal = foot.distance > 1e-9 * reference.diagonal() ? (1.0 / foot.distance) * away
                                                                 : reference.normal(foot.triangle);
        tie.level = dot(tie.normal, foot.point);
        ties.push_back(tie);
    };
    for (const auto &w : kInner)
        tie_point({w[0], w[1], w[2]});
    for (int k = 0; k < 3; ++k) { // each edge from one of its two sides
        if (f[k] > f[(k + 1) % 3])
            continue;
        for (int j = 1; j < kSteps; ++j) {
            std::array<double, 3> weight{};
            weight[k] = 1.0 - static_cast<double>(j) / kSteps;
            weight[(k + 1) % 3] = static_cast<double>(j) / kSteps;
            tie_point(weight);
        }
    }
}

/// The tie of a vertex of the reference to the facet nearest to it; none where they touch.
void tie_vertex(const Vec3 &p, const TriangleTree &tree, const std::vector<std::array<int, 3>> &facets, double touch,
                int &near, std::vector<Tie> &ties) {
    const auto at = tree.nearest(p, near);
    near = at.triangle;
    const double distance = std::sqrt(at.square);
    if (!(distance > touch))
        return;
    Tie tie{facets[at.triangle], {at.weight[0], at.weight[1], at.weight[2]}, (1.0 / distance) * (at.point - p), 0.0};
    tie.level = dot(tie.normal, p);
    ties.push_back(tie);
}

/// What `fill(first, last, ties)` makes of the chunks of 0..count, one after the other.
template <class Fill> void gather(std::size_t count, const Workers &workers, const Fill &fill, std::vector<Tie> &ties) {
    constexpr std::size_t kChunk = 256;
    std::vector<std::vector<Tie>> parts((count + kChunk - 1) / kChunk);
    workers.for_chunks(count, kChunk,
                       [&](std::size_t first, std::size_t last) { fill(first, last, parts[first / kChunk]); });
    for (const auto &part : parts)
        ties.insert(ties.end(), part.begin(), part.end());
}

} // namespace

std::vector<Tie> tie_surface(const Cloud &cloud, const Complex &complex, const Reference &reference,
                             const Workers &workers) {
    const auto &data = reference.data();
    const std::vector<std::array<int, 3>> facets = surface_facets(complex);
    const TriangleTree tree(cloud.points, facets);
    std::vector<Tie> ties;
    gather(
        facets.size(), workers,
        [&](std::size_t first, std::size_t last, std::vector<Tie> &own) {
            for (std::size_t f = first; f < last; ++f)
                tie_facet(cloud, reference, facets[f], own);
        },
        ties);
    gather(
        data.points.size(), workers,
        [&](std::size_t first, std::size_t last, std::vector<Tie> &own) {
            int near = -1;
            for (std::size_t v = first; v < last; ++v) {
                const auto &patches = reference.patches_at_vertex(static_cast<int>(v));
                if (!std::all_of(patches.begin(), patches.end(), [&](int p) { return reference.planar(p); }))
                    tie_vertex(data.points[v], tree, facets, 1e-9 * reference.diagonal(), near, own);
            }
        },
        ties);
    return ties;
}

void fit_heights(Cloud &cloud, const Reference &reference, const std::vector<Tie> &ties,
                 const std::vector<Vec3> &direction, const FitForm &form, const Workers &workers) {
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
        risers.push_back({static_cast<int>(v), 0.0, 0.0});
    }
    workers.for_each(risers.size(), 512, [&](std::size_t i) {
        const int v = risers[i].point;
        Vec3 base = cloud.points[v];
        const Foot foot = reference.nearest(base, cloud.label[v], cloud.near[v]);
        reference.to_patch(base, foot);
        risers[i].at = dot(cloud.points[v] - foot.point, direction[v]);
        risers[i].wanted = dot(base - foot.point, direction[v]);
    });
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
