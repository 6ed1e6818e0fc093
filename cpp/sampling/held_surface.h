#pragma once

#include "base/cells.h"
#include "base/vec3.h"
#include "domain/reference.h"
#include "domain/sizing.h"
#include "geometry/protecting_balls.h"
#include "sampling/cloud.h"
#include "sampling/restricted_delaunay.h"

#include <map>
#include <set>
#include <span>
#include <vector>

namespace wct::sampling {

/// The triangulation of some patches, given facet by facet, and of some curves, edge by edge.
struct HeldFacets {
    std::vector<Vec3> points;
    std::vector<Stratum> role;
    std::vector<int> label;    // patch, curve or vertex of the reference
    std::vector<Facet> facets; // running as the patches' triangles do
    std::vector<int> patch;    // of each facet
    std::vector<Edge> edges;   // of curves whose patches are not given
    std::vector<int> curves;   // those curves
};

/// Patches whose facets are given, and curves whose edges are, that stay to the bit while everything else is sampled
/// anew.
///
/// A facet is in every Delaunay triangulation whose points stay out of one ball through its corners, its protecting
/// ball: here the smallest of those that hold no other held point and no corner. So is an edge, with the smallest ball
/// through its ends. Points that come too near move out of the balls, or go. Every tet on a held facet has the region
/// of that side of the facet.
class HeldSurface {
  public:
    /// `facets` cover patches of the reference; held with them are the curves that a patch of them is at.
    HeldSurface(const HeldFacets &facets, const domain::Reference &reference);

    /// Whether points with this role and label, and creases, belong to what is held.
    bool holds(Stratum role, int label) const;
    bool holds_curve(int curve) const { return curves_.contains(curve); }
    bool holds_patch(int patch) const { return patches_.contains(patch); }
    /// Sizes on the held patches and curves are the means of their own edges.
    void set_sizes(domain::Sizing &sizing) const;
    /// Held points take the places of others of what is held.
    void put(Cloud &cloud, const domain::Sizing &sizing) const;
    /// Only held points are left of what is held.
    void drop_others(Cloud &cloud) const;
    /// Move points out of the protecting balls; those that find no place go, but for those that are not to move.
    void clear(Cloud &cloud) const;
    /// Where four points on a circle have two triangulations, take the one with the held facets.
    void recover(const Cloud &cloud, delaunay::Triangulation &all) const;
    /// Give the tets on held facets the region of their side.
    void label(const Cloud &cloud, RestrictedDelaunay &complex) const;
    /// Per facet of a mesh of these points the patch of the held facet it is, or -1.
    std::vector<int> patches(const Cloud &cloud, std::span<const Facet> facets) const;
    /// Per point of the cloud the held point it is, or -1.
    std::vector<int> numbers(const Cloud &cloud) const;
    /// Whether the surface of the complex has all held facets, and the complex the edges.
    bool complete(const Cloud &cloud, const RestrictedDelaunay &complex) const;

  private:
    void protect();
    void protect_edges(std::span<const Vec3> others, std::vector<geometry::Sphere> &balls) const;
    bool clear(Vec3 &p, Stratum role, int label) const;
    /// visit(tet, i, k, above) for each facet i of a tet that is held facet k; above: its normal points into the tet.
    template <class Visit> void each_held(const Cloud &cloud, const std::vector<Tet> &tets, const Visit &visit) const;

    const domain::Reference &reference_;
    HeldFacets held_;
    std::set<int> patches_, curves_, corners_;
    std::vector<double> size_; // per point: the mean of its held edges
    std::map<std::array<double, 3>, int> at_;
    std::map<Facet, int> facet_;      // corners ascending
    geometry::ProtectingBalls balls_; // but for those of facets and edges that no ball protects
};

} // namespace wct::sampling
