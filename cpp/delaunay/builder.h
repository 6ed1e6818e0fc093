#pragma once

#include "base/vec3.h"
#include "delaunay/delaunay.h"

#include <array>
#include <climits>
#include <span>
#include <vector>

namespace wct::delaunay {

constexpr int kInfinite = -1;  // the vertex of every ghost, always its last
constexpr int kDead = -2;      // first vertex of a tet that is not in use
constexpr int kOpen = INT_MIN; // a facet whose neighbour is not known yet

/// The order of points by their coordinates, the first that differs.
inline bool lies_before(const Vec3 &p, const Vec3 &q) {
    if (p.x != q.x)
        return p.x < q.x;
    if (p.y != q.y)
        return p.y < q.y;
    return p.z < q.z;
}

/// The triangulation under construction. A facet is named 4 * tet + the corner it lies opposite. Replacing that corner
/// of a positive tet by a point on its side of the facet leaves the tet positive, so new tets keep the corners of the
/// old one in place. A ghost counts as positive if a point that sees its facet from outside would make it so.
class Builder {
  public:
    explicit Builder(std::span<const Vec3> points);
    Triangulation result() const;

  protected:
    /// Kept together, not as an array of each: a tet is met at random, then asked for all of this.
    struct Tet {
        std::array<int, 4> corners;
        std::array<int, 4> across; // the facet opposite each corner, as named from the other side
        int mark;                  // 2 * vertex where found in conflict with it, + 1 where found not to be
    };

    bool alive(int tet) const { return tets_[tet].corners[0] != kDead; }
    bool is_ghost(int tet) const { return tets_[tet].corners[3] == kInfinite; }
    int &across(int facet) { return tets_[facet >> 2].across[facet & 3]; }
    const Vec3 &corner(int tet, int i) const { return points_[tets_[tet].corners[i]]; }
    bool in_conflict(int tet, const Vec3 &p) const;
    bool in_perturbed_sphere(int tet, const Vec3 &p) const;
    int take_tet();

    std::vector<int> order_;   // index, in the caller's numbering, of each vertex: the order of insertion
    std::vector<Vec3> points_; // in that order, so what is near in space is near in memory
    std::vector<Tet> tets_;
    std::vector<int> unused_; // tets to be reused

  private:
    int side(int facet, const Vec3 &p) const;
    void start();
    void refuse_pair(int i, int j) const;
    int locate(const Vec3 &p) const;
    void insert(int vertex);
    void dig(int vertex, int tet);
    void fill(int vertex);
    void join(int facet, int created);

    std::vector<int> cavity_; // tets in conflict with the vertex being inserted
    std::vector<int> rim_;    // the cavity's facets, named from inside
    int last_ = 0;            // a tet near the last insertion
};

} // namespace wct::delaunay
