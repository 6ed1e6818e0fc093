#include "geometry/triangle_edges.h"

#include "base/disjoint_sets.h"

#include <algorithm>
#include <tuple>

namespace wct::geometry {

TriangleEdges::TriangleEdges(std::span<const Facet> triangles) {
    struct Side {
        Edge edge;
        int owner;
        bool forward;
        bool operator<(const Side &o) const { return std::tie(edge, owner) < std::tie(o.edge, o.owner); }
    };
    std::vector<Side> sides;
    sides.reserve(3 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (int i = 0; i < 3; ++i) {
            const int a = triangles[t][i], b = triangles[t][(i + 1) % 3];
            sides.push_back({sorted(a, b), static_cast<int>(t), a < b});
        }
    std::sort(sides.begin(), sides.end());
    for (std::size_t k = 0; k < sides.size(); ++k) {
        if (k == 0 || sides[k].edge != sides[k - 1].edge) {
            edges_.push_back(sides[k].edge);
            starts_.push_back(k);
        }
        owners_.push_back(sides[k].owner);
        forward_.push_back(sides[k].forward);
    }
    starts_.push_back(sides.size());
}

std::span<const int> TriangleEdges::owners(const Edge &edge) const {
    const auto at = std::lower_bound(edges_.begin(), edges_.end(), edge);
    return at != edges_.end() && *at == edge ? owners(static_cast<std::size_t>(at - edges_.begin()))
                                             : std::span<const int>{};
}

std::vector<double> bend_angles(std::span<const Vec3> points, std::span<const Facet> triangles,
                                const TriangleEdges &edges) {
    const auto normal = [&](int t) {
        const auto &[a, b, c] = triangles[t];
        return normal_of({points[a], points[b], points[c]});
    };
    std::vector<double> out;
    out.reserve(edges.count());
    for (std::size_t e = 0; e < edges.count(); ++e)
        out.push_back(angle(normal(edges.first(e)), (edges.same_way(e) ? -1.0 : 1.0) * normal(edges.last(e))));
    return out;
}

std::vector<int> sheets_at(std::span<const Facet> triangles, const TriangleEdges &edges, std::size_t points) {
    // Corners of triangles, joined where they share an edge there: a sheet has one set of them.
    const auto corner = [&](int t, int v) {
        return 3 * t + static_cast<int>(std::find(triangles[t].begin(), triangles[t].end(), v) - triangles[t].begin());
    };
    DisjointSets corners(3 * triangles.size());
    for (std::size_t e = 0; e < edges.count(); ++e) {
        const auto owners = edges.owners(e);
        for (std::size_t k = 1; k < owners.size(); ++k)
            for (const int v : edges.edges()[e])
                corners.join(corner(owners[k - 1], v), corner(owners[k], v));
    }
    std::vector<int> sheets(points, 0);
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (int i = 0; i < 3; ++i) {
            const int c = 3 * static_cast<int>(t) + i;
            sheets[triangles[t][i]] += corners.find(c) == c;
        }
    return sheets;
}

std::vector<int> joined_patches(std::span<const int> patch, const TriangleEdges &edges, std::span<const Edge> gone) {
    const std::size_t count =
        patch.empty() ? 0 : static_cast<std::size_t>(*std::max_element(patch.begin(), patch.end())) + 1;
    DisjointSets patches(count);
    for (std::size_t e = 0; e < edges.count(); ++e) {
        if (!std::binary_search(gone.begin(), gone.end(), edges.edges()[e]))
            continue;
        const auto owners = edges.owners(e);
        for (std::size_t k = 1; k < owners.size(); ++k) {
            const auto [low, high] = std::minmax({patches.find(patch[owners[k - 1]]), patches.find(patch[owners[k]])});
            patches.join(high, low); // the smallest stands for all
        }
    }
    std::vector<int> out(count);
    for (std::size_t p = 0; p < count; ++p)
        out[p] = patches.find(static_cast<int>(p));
    return out;
}

} // namespace wct::geometry
