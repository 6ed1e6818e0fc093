#include "sampling/surface_fit.h"

#include "geometry/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

namespace wct::sampling {

namespace {

/// Samples of a facet besides its edges: the corners' own third and the middle.
constexpr double kInner[4][3] = {{1. / 3, 1. / 3, 1. / 3}, {.5, .25, .25}, {.25, .5, .25}, {.25, .25, .5}};

constexpr double kTouch = 1e-9; // distance at which surfaces touch, in diagonals
constexpr int kSteps = 6;       // along an edge: where it crosses a bend of the reference, it is off most

Vec3 blend(const Cloud &cloud, const Tie &tie) {
    return tie.weight[0] * cloud.points[tie.corner[0]] + tie.weight[1] * cloud.points[tie.corner[1]] +
           tie.weight[2] * cloud.points[tie.corner[2]];
}

/// The edges that a facet samples: each edge of the surface from one of its two sides.
bool samples_edge(const Facet &f, int k) {
    return f[k] < f[(k + 1) % 3];
}

std::size_t samples_of(const Facet &f) {
    return std::size(kInner) + (kSteps - 1) * (samples_edge(f, 0) + samples_edge(f, 1) + samples_edge(f, 2));
}

/// Ties of one facet's samples to the reference, from `tie` on; those over planes stay empty.
void tie_facet(const Cloud &cloud, const domain::Reference &reference, const Facet &f, Tie *tie) {
    int near = std::max({cloud.near[f[0]], cloud.near[f[1]], cloud.near[f[2]]});
    const auto tie_point = [&](const std::array<double, 3> &weight) {
        Tie made{f, weight, {}, 0.0};
        const Vec3 p = blend(cloud, made);
        const domain::Foot foot = reference.nearest(p, -1, near);
        near = foot.triangle;
        if (!reference.planar(reference.data().patch[foot.triangle])) {
            // Across an edge of the reference the distance grows along the way to the foot; on it, along the normal.
            const Vec3 away = p - foot.point;
            made.normal = foot.distance > kTouch * reference.diagonal() ? (1.0 / foot.distance) * away
                                                                        : reference.normal(foot.triangle);
            made.level = dot(made.normal, foot.point);
            *tie = made;
        }
        ++tie;
    };
    for (const auto &w : kInner)
        tie_point({w[0], w[1], w[2]});
    for (int k = 0; k < 3; ++k) {
        if (!samples_edge(f, k))
            continue;
        for (int j = 1; j < kSteps; ++j) {
            std::array<double, 3> weight{};
            weight[k] = 1.0 - static_cast<double>(j) / kSteps;
            weight[(k + 1) % 3] = static_cast<double>(j) / kSteps;
            tie_point(weight);
        }
    }
}

/// Per point the ties that it is a corner of.
class TieUses {
  public:
    struct Use {
        int tie;
        double slope; // of the tie's height when the point rises
    };

    TieUses(std::size_t points, const std::vector<Tie> &ties, const std::vector<Vec3> &direction)
        : first_(points + 1, 0) {
        for (const Tie &tie : ties)
            for (const int v : tie.corner)
                ++first_[v + 1];
        for (std::size_t v = 0; v < points; ++v)
            first_[v + 1] += first_[v];
        uses_.resize(first_.back());
        auto next = first_;
        for (std::size_t t = 0; t < ties.size(); ++t)
            for (int k = 0; k < 3; ++k) {
                const int v = ties[t].corner[k];
                uses_[next[v]++] = {static_cast<int>(t), ties[t].weight[k] * dot(ties[t].normal, direction[v])};
            }
    }

    std::span<const Use> of(int point) const {
        return {uses_.data() + first_[point], uses_.data() + first_[point + 1]};
    }

  private:
    std::vector<std::size_t> first_;
    std::vector<Use> uses_;
};

/// A point that rises and sinks.
struct Riser {
    int point;
    double at;     // height over the patch
    double wanted; // the offset there
};

/// Points of curved patches that are not held and have a tie.
std::vector<Riser> find_risers(const Cloud &cloud, const domain::Reference &reference, const TieUses &uses,
                               const std::vector<Vec3> &direction, const Workers &workers) {
    std::vector<Riser> risers;
    for (int v = 0; v < static_cast<int>(cloud.count()); ++v)
        if (cloud.role[v] == Stratum::patch && !reference.planar(cloud.label[v]) && cloud.held[v] < Hold::all &&
            !uses.of(v).empty())
            risers.push_back({v, 0.0, 0.0});
    workers.for_each(risers.size(), 512, [&](std::size_t i) {
        const int v = risers[i].point;
        Vec3 base = cloud.points[v];
        const domain::Foot foot = reference.nearest(base, cloud.label[v], cloud.near[v]);
        reference.to_patch(base, foot);
        risers[i].at = dot(cloud.points[v] - foot.point, direction[v]);
        risers[i].wanted = dot(base - foot.point, direction[v]);
    });
    return risers;
}

/// The height that a point is to rise to: one step of Newton's on the penalties of its ties that are too long and on
/// the way to its offset.
double height_of(const Riser &r, std::span<const TieUses::Use> uses, const std::vector<double> &height,
                 const FitForm &form) {
    const double scale = 1.0 / form.limit;
    double slope = form.pull * (r.at - r.wanted) * scale;
    double bend = form.pull * scale;
    for (const TieUses::Use &use : uses) {
        const double h = height[use.tie];
        const double over = std::fabs(h) * scale - 1.0;
        if (over <= 0.0)
            continue;
        slope += std::copysign(over, h) * use.slope;
        bend += scale * use.slope * use.slope;
    }
    return std::clamp(r.at - slope / bend, -form.shell, form.shell);
}

} // namespace

std::vector<Tie> tie_surface(const Cloud &cloud, const RestrictedDelaunay &complex, const domain::Reference &reference,
                             const Workers &workers) {
    const auto &vertices = reference.data().points;
    const std::vector<Facet> facets = surface_facets(complex);
    std::vector<std::size_t> first{0}; // tie per facet, then of the vertices
    for (const auto &f : facets)
        first.push_back(first.back() + samples_of(f));
    std::vector<Tie> ties(first.back() + vertices.size()); // a place for each, so that threads can fill them
    workers.for_each(facets.size(), 256,
                     [&](std::size_t f) { tie_facet(cloud, reference, facets[f], &ties[first[f]]); });
    const geometry::TriangleTree tree(cloud.points, facets);
    workers.for_chunks(vertices.size(), 256, [&](std::size_t begin, std::size_t end) {
        int near = -1;
        for (std::size_t v = begin; v < end; ++v) {
            const auto &patches = reference.patches_at_vertex(static_cast<int>(v));
            if (std::all_of(patches.begin(), patches.end(), [&](int p) { return reference.planar(p); }))
                continue;
            const auto at = tree.nearest(vertices[v], near);
            near = at.triangle;
            const double distance = std::sqrt(at.square);
            if (!(distance > kTouch * reference.diagonal()))
                continue;
            const Vec3 normal = (1.0 / distance) * (at.point - vertices[v]);
            const std::array weight{at.weight[0], at.weight[1], at.weight[2]};
            ties[first.back() + v] = {facets[at.triangle], weight, normal, dot(normal, vertices[v])};
        }
    });
    std::erase_if(ties, [](const Tie &tie) { return tie.normal == Vec3{}; });
    return ties;
}

void fit_heights(Cloud &cloud, const domain::Reference &reference, const std::vector<Tie> &ties,
                 const std::vector<Vec3> &direction, const FitForm &form, const Workers &workers) {
    constexpr int sweeps = 10;
    std::vector<double> height;
    height.reserve(ties.size());
    for (const Tie &tie : ties)
        height.push_back(dot(tie.normal, blend(cloud, tie)) - tie.level);
    const TieUses uses(cloud.count(), ties, direction);
    std::vector<Riser> risers = find_risers(cloud, reference, uses, direction, workers);
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (Riser &r : risers) {
            const double to = height_of(r, uses.of(r.point), height, form);
            const double rise = to - r.at;
            r.at = to;
            cloud.points[r.point] += rise * direction[r.point];
            for (const TieUses::Use &use : uses.of(r.point))
                height[use.tie] += rise * use.slope;
        }
}

std::size_t count_off(const Cloud &cloud, const std::vector<Tie> &ties, double limit) {
    std::vector<Facet> off;
    for (const Tie &tie : ties)
        if (std::fabs(dot(tie.normal, blend(cloud, tie)) - tie.level) > limit)
            off.push_back(tie.corner);
    std::sort(off.begin(), off.end());
    return static_cast<std::size_t>(std::unique(off.begin(), off.end()) - off.begin());
}

} // namespace wct::sampling
