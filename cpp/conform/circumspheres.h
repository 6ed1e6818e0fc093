#pragma once

#include "geometry/circumspheres.h"
#include "sampling/cloud.h"
#include "sampling/restricted_delaunay.h"

#include <vector>

namespace wct::conform {

/// The tets' circumspheres, and where their centers lie from the facets as their corners are now.
class Circumspheres {
  public:
    /// It looks at the caller's points and tets: they must outlive it.
    Circumspheres(const sampling::Cloud &cloud, const sampling::RestrictedDelaunay &complex)
        : cloud_(cloud), complex_(complex) {}

    /// Of the tets as they are now.
    void measure();

    std::size_t size() const { return spheres_.size(); }
    const geometry::Sphere &operator[](int t) const { return spheres_[t]; }
    /// Signed height of a tet's circumcenter over its facet i.
    double height(int t, int i) const;
    /// Whether the dual edge through facet i of a tet, between its circumcenter and the next tet's, is no longer than
    /// this share of the mean of their radii.
    bool tied(int t, int i, double least) const;

  private:
    const sampling::Cloud &cloud_;
    const sampling::RestrictedDelaunay &complex_;
    std::vector<geometry::Sphere> spheres_;
};

} // namespace wct::conform
