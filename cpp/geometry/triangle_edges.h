#pragma once

#include "base/cells.h"
#include "base/vec3.h"

#include <cstdint>
#include <span>
#include <vector>

namespace wct::geometry {

/// Every edge of some triangles once, ends ascending, in lexicographic order, and the triangles that have it.
class TriangleEdges {
  public:
    explicit TriangleEdges(std::span<const Facet> triangles);

    std::size_t count() const { return edges_.size(); }
    const std::vector<Edge> &edges() const { return edges_; }
    /// The triangles of edge e, ascending.
    std::span<const int> owners(std::size_t e) const {
        return std::span(owners_).subspan(starts_[e], starts_[e + 1] - starts_[e]);
    }
    /// The triangles of the edge with these ends, ascending both; empty where it is none.
    std::span<const int> owners(const Edge &edge) const;
    bool paired(std::size_t e) const { return starts_[e + 1] - starts_[e] == 2; }
    int first(std::size_t e) const { return owners_[starts_[e]]; }
    int last(std::size_t e) const { return owners_[starts_[e + 1] - 1]; }
    /// Whether its first and last triangle run through it in the same direction: their normals disagree on a side.
    bool same_way(std::size_t e) const { return forward_[starts_[e]] == forward_[starts_[e + 1] - 1]; }

  private:
    std::vector<Edge> edges_;
    std::vector<std::size_t> starts_; // one more than edges
    std::vector<int> owners_;
    std::vector<std::uint8_t> forward_; // of each owner, whether it runs from the smaller end to the larger
};

/// Per edge the angle between its first and last triangle's normals, in radians.
std::vector<double> bend_angles(std::span<const Vec3> points, std::span<const Facet> triangles,
                                const TriangleEdges &edges);

/// Per point how many sheets of the surface meet there that share no edge; 0 where no triangle is.
std::vector<int> sheets_at(std::span<const Facet> triangles, const TriangleEdges &edges, std::size_t points);

/// Per patch the one that it becomes where some edges part nothing any more: the smallest of those that they joined.
/// `gone`: these edges, ends ascending, in lexicographic order.
std::vector<int> joined_patches(std::span<const int> patch, const TriangleEdges &edges, std::span<const Edge> gone);

} // namespace wct::geometry
