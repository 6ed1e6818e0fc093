#include "sampling/crease_recovery.h"

#include "base/sort_unique.h"
#include "sampling/curve_chains.h"
#include "sampling/held_surface.h"

#include <algorithm>

namespace wct::sampling {

namespace {

/// Crease points are not put closer than half of this, in sizes.
constexpr double kClosest = 0.5;
constexpr double kCrowded = 0.4 * kClosest; // of new points from others, likewise
/// How near a crease a patch point that takes its edge away stands, in sizes: farther ones leave room for a new point.
constexpr double kOn = 0.2;

using Edges = std::vector<Edge>;

/// Edges that a crease may run along: those of the surface, and where there is none, of tets.
Edges possible_creases(const Cloud &cloud, const domain::Reference &reference, const RestrictedDelaunay &complex) {
    Edges edges = surface_edges(complex);
    const std::vector<char> wire = on_wires(cloud, reference);
    if (std::find(wire.begin(), wire.end(), 1) == wire.end())
        return edges;
    for (std::size_t t = 0; t < complex.all.tets.size(); ++t)
        for (const auto &[i, j] : kEdges) {
            const int v = complex.all.tets[t][i], w = complex.all.tets[t][j];
            if (complex.region[t] >= 0 && (wire[v] || wire[w]))
                edges.push_back(sorted(v, w));
        }
    sort_unique(edges);
    return edges;
}

std::vector<CreaseGap> find_gaps(const Cloud &cloud, const domain::Reference &reference, const Edges &edges) {
    std::vector<CreaseGap> gaps;
    const auto chains = curve_chains(cloud, reference);
    for (std::size_t c = 0; c < chains.size(); ++c)
        for (std::size_t k = 0; k + 1 < chains[c].size(); ++k) {
            const CurveStop &from = chains[c][k], &to = chains[c][k + 1];
            const int v = from.point, w = to.point;
            if (v != w && !std::binary_search(edges.begin(), edges.end(), sorted(v, w)))
                gaps.push_back({static_cast<int>(c), v, w, 0.5 * (from.at + to.at)});
        }
    return gaps;
}

/// Per point that a gap starts from, the points joined to it on the surface; empty for all others.
std::vector<std::vector<int>> neighbours_of(const Cloud &cloud, const Edges &edges,
                                            const std::vector<CreaseGap> &gaps) {
    std::vector<char> asked(cloud.count(), 0);
    for (const CreaseGap &gap : gaps)
        asked[gap.first] = 1;
    std::vector<std::vector<int>> out(cloud.count());
    for (const auto &[v, w] : edges) {
        if (asked[v])
            out[v].push_back(w);
        if (asked[w])
            out[w].push_back(v);
    }
    return out;
}

/// The patch point of these that stands in the gap: between its ends, nearest to the curve and all but on it. -1: none.
int standing_in(const CreaseGap &gap, const std::vector<int> &near, double size, const Cloud &cloud,
                const domain::Reference &reference) {
    const std::vector<int> &patches = reference.patches_at_curve(gap.curve);
    const Vec3 &a = cloud.points[gap.first], &b = cloud.points[gap.second];
    int best = -1;
    double least = kOn * size;
    for (const int p : near) {
        if (cloud.role[p] != Stratum::patch || !std::binary_search(patches.begin(), patches.end(), cloud.label[p]) ||
            dot(a - cloud.points[p], b - cloud.points[p]) >= 0.0)
            continue;
        const double far = reference.nearest_on_curve(cloud.points[p], gap.curve, true).distance;
        if (far < least) {
            least = far;
            best = p;
        }
    }
    return best;
}

} // namespace

std::vector<CreaseGap> crease_gaps(const Cloud &cloud, const domain::Reference &reference,
                                   const RestrictedDelaunay &complex) {
    return find_gaps(cloud, reference, possible_creases(cloud, reference, complex));
}

int recover_creases(Cloud &cloud, const domain::Reference &reference, const RestrictedDelaunay &complex,
                    const HeldSurface *held, const Workers &workers) {
    const Edges edges = possible_creases(cloud, reference, complex);
    const std::vector<CreaseGap> gaps = find_gaps(cloud, reference, edges);
    if (gaps.empty())
        return 0;
    const auto near = neighbours_of(cloud, edges, gaps);
    PointGrid grid = surface_grid(cloud, kCrowded);
    int got = 0;
    for (const CreaseGap &gap : gaps) {
        if (held && held->holds_curve(gap.curve))
            continue; // its facets bring it
        const double size = 0.5 * (cloud.size[gap.first] + cloud.size[gap.second]);
        if (const int p = standing_in(gap, near[gap.first], size, cloud, reference); p >= 0) {
            cloud.role[p] = Stratum::crease;
            cloud.label[p] = gap.curve;
            ++got;
            continue;
        }
        if (norm(cloud.points[gap.first] - cloud.points[gap.second]) < kClosest * size)
            continue; // splitting again and again would not help
        // Half-way along the curve: half-way between the points may be nearer to some other part of it.
        const domain::Curve &curve = reference.curves()[gap.curve];
        const int step = static_cast<int>(gap.at);
        const double along = gap.at - step;
        const Vec3 middle = (1.0 - along) * reference.data().points[curve.at(step)] +
                            along * reference.data().points[curve.at(step + 1)];
        if (grid.crowded(middle, kCrowded * size))
            continue;
        grid.add(middle, kCrowded * size);
        cloud.add(middle, Stratum::crease, gap.curve, size);
        ++got;
    }
    if (got)
        retract(cloud, reference, workers);
    return got;
}

} // namespace wct::sampling
