#pragma once

#include "base/cells.h"
#include "domain/region_map.h"
#include "geometry/protecting_balls.h"
#include "sampling/restricted_delaunay.h"

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace wct::refill {

/// What of a mesh's surface has to stay, facet by facet, while the inside is triangulated anew by Delaunay.
///
/// A facet is in every Delaunay triangulation whose points stay out of one ball through its corners: its protecting
/// ball, here the smallest of those that hold no pinned point. It is also where the apex of a well-centered tet on the
/// facet cannot be. Where the surface has facets without such a ball, the tets behind them are kept as they are, and
/// their inner facets are pinned instead.
class PinnedFacets {
  public:
    /// `facets`: those to keep, the boundary's all among them; `pinned`, per point: it has to stay; `edges`: those to
    /// keep, on the surface or not.
    /// `squares`: count on swaps of diagonals where other pinned points lie on a facet's smallest ball.
    PinnedFacets(const domain::InputMesh &mesh, std::span<const Facet> facets, const std::vector<char> &pinned,
                 std::span<const Edge> edges, bool squares);

    /// Points of the input mesh that every triangulation starts with, ascending.
    const std::vector<int> &points() const { return points_; }
    /// Whether an input tet is kept as it is.
    bool keeps(int tet) const { return kept_[tet] != 0; }
    std::size_t kept() const { return kept_count_; }
    bool keeps_all() const { return kept_count_ == kept_.size(); }

    /// Move p out of the protecting balls; false where that fails.
    bool clear(Vec3 &p) const {
        return balls_.clear(p, [](const Vec3 &) {});
    }
    /// Set the region of each tet, -1 outside and where input tets are kept. The triangulation is Delaunay's of `at`,
    /// which begins with points(); where it has the other diagonal of a square, that is swapped. False if a pinned
    /// facet is missing.
    bool label(sampling::RestrictedDelaunay &complex, std::span<const Vec3> at) const;

  private:
    /// A facet between places in points(), ascending, and the regions its normal comes from and points to.
    struct Sides {
        Facet facet;
        std::array<int, 2> region{-1, -1};
    };
    void gather();
    void recover(delaunay::Triangulation &all, std::span<const Vec3> at) const;
    std::vector<geometry::Sphere> protect(const delaunay::Triangulation &all, std::vector<char> &missing) const;
    bool keep_behind(const std::vector<char> &missing);
    int find(const Facet &facet) const;
    /// Of entry k of sides_.
    std::array<Vec3, 3> corners(std::size_t k) const;
    /// visit(tet, i, k, above) for each facet i of a tet that is entry k of sides_; above: its normal points inwards.
    template <class Visit> void each_pinned(const std::vector<Tet> &tets, const Visit &visit) const;

    const domain::InputMesh &mesh_;
    const std::vector<char> &pinned_;
    bool squares_;
    std::vector<Facet> facets_; // to keep, ascending
    std::vector<char> kept_;
    std::size_t kept_count_ = 0;
    std::vector<int> points_;
    std::vector<Sides> sides_;               // by facet
    std::vector<std::array<int, 2>> behind_; // per entry of sides_: input tets below and above, -1 where none is open
    geometry::ProtectingBalls balls_;
};

} // namespace wct::refill
