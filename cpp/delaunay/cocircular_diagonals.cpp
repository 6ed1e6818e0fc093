#include "delaunay/cocircular_diagonals.h"

#include "base/facet_uses.h"
#include "delaunay/corners.h"
#include "geometry/predicates.h"

#include <algorithm>
#include <tuple>
#include <utility>
#include <vector>

namespace wct::delaunay {

namespace {

/// The tets at a facet that still have it.
std::vector<int> tets_at(const Triangulation &all, const FacetUses &uses, const Facet &facet) {
    std::vector<int> tets;
    for (const FacetUses::Use &use : uses.of(sorted(facet)))
        if (std::all_of(facet.begin(), facet.end(), [&](int v) { return place_of(all.tets[use.tet()], v) < 4; }))
            tets.push_back(use.tet());
    return tets;
}

/// Tets (a, b, d, p) and (b, c, d, p) that become (a, b, c, p) and (a, c, d, p).
struct Pair {
    int first, second;
};

bool positive(std::span<const Vec3> points, const Corners &tet) {
    return geometry::orient3d(points[tet[0]], points[tet[1]], points[tet[2]], points[tet[3]]) > 0;
}

bool swap(Triangulation &all, std::span<const Vec3> points, const FacetUses &uses, int a, int b, int c, int d) {
    const std::vector<int> firsts = tets_at(all, uses, {a, b, d}), seconds = tets_at(all, uses, {b, c, d});
    if (firsts.empty() || firsts.size() != seconds.size())
        return false;
    std::vector<Pair> pairs;
    for (const int first : firsts)
        for (const int second : seconds)
            if (all.neighbours[first][place_of(all.tets[first], a)] == second)
                pairs.push_back({first, second});
    if (pairs.size() != firsts.size())
        return false;
    for (const auto &[first, second] : pairs) {
        Corners one = all.tets[first], two = all.tets[second];
        one[place_of(one, d)] = c;
        two[place_of(two, b)] = a;
        if (!positive(points, one) || !positive(points, two))
            return false;
    }
    for (const auto &[first, second] : pairs) {
        Corners &one = all.tets[first], &two = all.tets[second];
        Corners &by_one = all.neighbours[first], &by_two = all.neighbours[second];
        const int at_a = place_of(one, a), at_b = place_of(one, b), at_c = place_of(two, c), at_d = place_of(two, d);
        const int over_adp = by_one[at_b], over_bcp = by_two[at_d];
        one[place_of(one, d)] = c;
        two[place_of(two, b)] = a;
        by_one[at_a] = over_bcp;
        by_one[at_b] = second;
        by_two[at_c] = over_adp;
        by_two[at_d] = first;
        if (over_bcp >= 0)
            std::replace(all.neighbours[over_bcp].begin(), all.neighbours[over_bcp].end(), second, first);
        if (over_adp >= 0)
            std::replace(all.neighbours[over_adp].begin(), all.neighbours[over_adp].end(), first, second);
    }
    return true;
}

} // namespace

int swap_diagonals(Triangulation &all, std::span<const Vec3> points, std::span<const Facet> wanted) {
    if (wanted.empty())
        return 0;
    std::vector<std::tuple<Edge, int>> edges; // of the wanted facets, with the corner opposite
    for (const auto &[a, b, c] : wanted)
        for (const auto &[edge, other] : {std::pair(Edge{a, b}, c), std::pair(Edge{a, c}, b), std::pair(Edge{b, c}, a)})
            edges.emplace_back(edge, other);
    std::sort(edges.begin(), edges.end());
    const FacetUses uses(all.tets, points.size());
    int swapped = 0;
    for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
        const auto &[edge, b] = edges[k];
        const auto &[next, d] = edges[k + 1];
        if (edge == next && swap(all, points, uses, edge[0], b, edge[1], d))
            ++swapped;
    }
    return swapped;
}

} // namespace wct::delaunay
