#pragma once

#include "base/cells.h"
#include "base/random.h"
#include "conform/circumspheres.h"
#include "conform/conform.h"
#include "conform/surface_probes.h"
#include "geometry/circumspheres.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace wct::conform {

/// One round: the complex of the points as they are, and what is wrong with it.
class Round {
  public:
    Round(ConformingCloud &points, const domain::Reference &reference, const SurfaceProbes &probes,
          const domain::RegionMap &map, const ConformOptions &options, double sharpest, Random &random,
          const Workers &workers);

    const sampling::RestrictedDelaunay &complex() const { return complex_; }

    /// Look for faults and change the points against them, where there are none but slivers against about this share of
    /// those; the complex is then out of date.
    Faults mend(double share);
    /// Whether anything was done against slivers, or waits for another round.
    bool may_change() const { return may_change_; }

  private:
    /// Width, in radii, of where a point may come for a circle's center: squares make squares.
    static constexpr double kOff = 0.4;

    template <std::size_t n> std::array<Vec3, n> corners(const std::array<int, n> &cell) const {
        std::array<Vec3, n> at;
        std::transform(cell.begin(), cell.end(), at.begin(), [&](int v) { return cloud_.points[v]; });
        return at;
    }
    /// What a tet's facet i adds to the dual area of its edge opposite corner v, in lengths of the edge.
    double share(int t, int i, int v) const;
    bool stays(int patch) const {
        return static_cast<std::size_t>(patch) < options_.stays.size() && options_.stays[patch] != 0;
    }
    bool inside(int v) const { return cloud_.role[v] == Stratum::interior; }
    bool beyond(int t, int i) const { return spheres_.height(t, i) <= least() * spheres_[t].radius; }
    /// The shortest length that a dual may have: where the mesh is to be one-sided it is not zero.
    double least() const { return options_.one_sided ? options_.least : -options_.tied; }
    /// Must the circumcenter stay on this side of the facet? Where a region ends, but for a single Delaunay one.
    bool outer(int t, int i) const;

    /// Flat tets between surface points are not outside but where they lie in the boundary, of one patch or of several
    /// in one plane: between the two sides of a layer they belong to it, in an interface to the region behind it.
    void take_in_flat();
    int region_of_flat(const Tet &tet) const;

    /// Take flat tets with their circumcenter beyond them off curved patches: flips of the surface. At an interface
    /// they go to the region beyond.
    void peel();

    /// Remove the points inside a ball that may go; false if there are none.
    bool clear(const std::vector<int> &candidates, const geometry::Sphere &ball);

    void mend_creases();
    const std::vector<int> &all_inside();

    void mend_surface();
    /// Bring the own surface back at a point of it.
    void restore(const domain::Foot &foot);

    void mend_outer();
    /// Where the two outer facets of a region at an edge are obtuse opposite it, the dual area that the region has
    /// there may be negative although all circumcenters are inside.
    void mend_edges();

    /// Of the angle at the first corner.
    double cosine(const Facet &f) const;

    /// Put a point on the patch of a surface facet, at its circumcenter or by `off` radii beside it.
    void split_facet(const Facet &f, double off);

    /// Across a layer thinner than the sphere of a facet that was split comes a point over the new one: without it the
    /// one would be in spheres of facets there, and a split there answered by one here. What is between the two layers
    /// of facets then is on common spheres, so this is nothing where no dual may have length zero.
    void mirror(const Vec3 &on, const Vec3 &normal, double radius, double size);

    int nearest_of(const std::vector<int> &patches, const Vec3 &p) const;
    double size_of(const Facet &f) const;

    void mend_ties();

    /// Put a point near the circumcenter of a tet, or near its centroid where the region is another one there.
    void put_inside(int t);

    /// Flat tets are no faults of a Delaunay mesh, but what is given has none: points inside are moved out of the
    /// sphere of such a tet, and where all four are on the surface one more comes into it. In layers too thin for that,
    /// as a point in the middle of a layer lies in the spheres of all facets round it, points of one side are put
    /// exactly opposite those of the other.
    void mend_slivers(double share);
    bool mend_sliver(int t);

    /// Where points of two planes are nearly opposite each other, as where both sides of a layer were meshed alike,
    /// four of them are nearly on a circle, and what is nearly flat between them is Delaunay. Put a point of this tet
    /// opposite another one, within its plane: then flat tets can be taken out. Where none is nearly opposite, one of
    /// them, new ones first, is moved a little. False if there is none to be moved.
    bool put_opposite(const Tet &tet);

    bool has_room(const geometry::Sphere &ball) const;
    void mend_tie(int t, int i, int other, std::vector<char> &moved);

    ConformingCloud &points_;
    const sampling::Cloud &cloud_;
    const domain::Reference &reference_;
    const SurfaceProbes &probes_;
    const domain::RegionMap &map_;
    const ConformOptions &options_;
    double sharpest_; // dihedral angle that a tet should have
    Random &random_;
    sampling::RestrictedDelaunay complex_;
    bool several_ = false; // regions
    Circumspheres spheres_;
    std::vector<std::pair<int, domain::Foot>> ridges_; // slivers on a bend too sharp to take them off
    sampling::Flaws flaws_;
    Faults faults_;
    bool may_change_ = false;
    std::vector<char> gone_;
    std::vector<int> all_inside_;
};

} // namespace wct::conform
