#include "library/crease_noise.h"

#include "base/disjoint_sets.h"
#include "base/sort_unique.h"
#include "library/edge_chains.h"

#include <algorithm>
#include <utility>

namespace wct::library {

namespace {

/// A crease with a free end is noise if it is shorter than this many local edge lengths.
constexpr double kDangling = 4.0;
/// Creases round up to so many triangles inside one patch are noise too: no shape has so few on its side.
constexpr int kSpeck = 4;

/// Per point the mean length of the surface's edges there.
std::vector<double> local_sizes(std::span<const Vec3> points, const std::vector<Edge> &edges) {
    std::vector<double> sum(points.size(), 0.0), count(points.size(), 0.0);
    for (const auto &[a, b] : edges)
        for (const int v : {a, b}) {
            sum[v] += norm(points[a] - points[b]);
            count[v] += 1.0;
        }
    for (std::size_t v = 0; v < points.size(); ++v)
        sum[v] /= std::max(count[v], 1.0);
    return sum;
}

/// What is known of a chain of segments.
struct Chain {
    double length = 0.0, size = 0.0;
    int segments = 0;
    bool free = false, hard = false;

    bool dangles() const { return free && !hard && length < kDangling * size / segments; }
};

/// Of these segments, flagged as hard or not, those that are left when dangling chains are cut off once.
std::vector<int> without_dangling_once(std::span<const Vec3> points, const std::vector<Edge> &all,
                                       const std::vector<int> &rows, const std::vector<std::uint8_t> &hard,
                                       std::span<const std::uint8_t> pinned, const std::vector<double> &size) {
    std::vector<Edge> segments;
    for (const int e : rows)
        segments.push_back(all[e]);
    const SegmentEnds ends(segments, points.size());
    std::vector<std::uint8_t> breaks(pinned.begin(), pinned.end());
    for (std::size_t s = 0; s < rows.size(); ++s)
        for (const int v : segments[s])
            breaks[v] |= hard[rows[s]];
    const std::vector<int> chain = chains_of(segments, breaks);
    std::vector<Chain> chains(segments.size());
    for (std::size_t s = 0; s < segments.size(); ++s) {
        const auto &[a, b] = segments[s];
        Chain &of = chains[chain[s]];
        of.length += norm(points[a] - points[b]);
        of.size += 0.5 * (size[a] + size[b]);
        ++of.segments;
        of.hard |= hard[rows[s]] != 0;
        for (const int v : {a, b})
            of.free |= ends.degree(v) == 1 && !pinned[v];
    }
    std::vector<int> left;
    for (std::size_t s = 0; s < rows.size(); ++s)
        if (!chains[chain[s]].dangles())
            left.push_back(rows[s]);
    return left;
}

/// Unmark short chains of creases with a free end, again and again.
void cut_dangling(std::span<const Vec3> points, const geometry::TriangleEdges &edges,
                  std::span<const std::uint8_t> pinned, const std::vector<double> &size, CreaseEdges &creases) {
    std::vector<int> rows;
    for (std::size_t e = 0; e < edges.count(); ++e)
        if (creases.crease[e])
            rows.push_back(static_cast<int>(e));
    for (std::size_t before = rows.size() + 1; rows.size() < before;) {
        before = rows.size();
        rows = without_dangling_once(points, edges.edges(), rows, creases.hard, pinned, size);
    }
    std::fill(creases.crease.begin(), creases.crease.end(), 0);
    for (const int e : rows)
        creases.crease[e] = 1;
}

/// Unmark the edges between a patch of a few triangles and the one larger patch all round it; whether there were any.
bool wipe_specks(const geometry::TriangleEdges &edges, std::size_t triangles, CreaseEdges &creases) {
    const std::vector<int> patch = patches_between(edges, creases.crease, triangles);
    std::vector<int> sizes(triangles, 0);
    for (const int p : patch)
        ++sizes[p];
    std::vector<std::uint8_t> never(triangles, 0); // patches with a rim that other than its angle makes
    std::vector<std::pair<int, int>> around;       // patches on either side of rims
    const auto is_rim = [&](std::size_t e) {
        return creases.crease[e] && (!edges.paired(e) || patch[edges.first(e)] != patch[edges.last(e)]);
    };
    for (std::size_t e = 0; e < edges.count(); ++e)
        if (is_rim(e)) {
            const int one = patch[edges.first(e)], other = patch[edges.last(e)];
            around.insert(around.end(), {{one, other}, {other, one}});
            if (creases.hard[e] || !edges.paired(e))
                never[one] = never[other] = 1;
        }
    sort_unique(around);
    std::vector<int> neighbours(triangles, 0);
    for (const auto &[one, other] : around) {
        ++neighbours[one];
        never[one] |= sizes[other] <= kSpeck;
    }
    const auto speck = [&](int p) { return sizes[p] <= kSpeck && neighbours[p] == 1 && !never[p]; };
    bool any = false;
    std::vector<std::size_t> gone;
    for (std::size_t e = 0; e < edges.count(); ++e)
        if (is_rim(e) && (speck(patch[edges.first(e)]) || speck(patch[edges.last(e)])))
            gone.push_back(e);
    for (const std::size_t e : gone) {
        creases.crease[e] = 0;
        any = true;
    }
    return any;
}

} // namespace

void drop_noise(std::span<const Vec3> points, std::size_t triangles, const geometry::TriangleEdges &edges,
                std::span<const std::uint8_t> pinned, CreaseEdges &creases) {
    const std::vector<double> size = local_sizes(points, edges.edges());
    do // a speck may be the end of a crease, and hide another speck
        cut_dangling(points, edges, pinned, size, creases);
    while (wipe_specks(edges, triangles, creases));
}

std::vector<int> patches_between(const geometry::TriangleEdges &edges, std::span<const std::uint8_t> crease,
                                 std::size_t triangles) {
    DisjointSets patches(triangles);
    for (std::size_t e = 0; e < edges.count(); ++e)
        if (edges.paired(e) && !crease[e])
            patches.join(edges.first(e), edges.last(e));
    return patches.numbers();
}

} // namespace wct::library
