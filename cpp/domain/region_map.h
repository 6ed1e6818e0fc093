#pragma once

#include "base/cells.h"
#include "base/vec3.h"
#include "domain/reference.h"
#include "geometry/box_tree.h"

#include <array>
#include <vector>

namespace wct::domain {

/// The mesh that came in: what its tets fill is inside.
struct InputMesh {
    std::vector<Vec3> points;
    std::vector<Tet> tets;
    std::vector<int> region; // per tet, >= 0
};

/// A place in the input mesh: a tet (or the nearest boundary facet's) and weights of its four corners.
struct Place {
    int tet = -1;
    double weight[4] = {0.0, 0.0, 0.0, 0.0};
};

/// Tells which region a point lies in, and where in the input mesh it is.
///
/// Where the input's boundary is a coarse copy of the surface, the strip between the two belongs to the side the
/// surface puts it on; everywhere else the input's tets decide, so that a surface with stray inner sheets does no harm.
class RegionMap {
  public:
    RegionMap(const InputMesh &mesh, const Reference &reference);

    /// Region at p, -1 outside. `foot`: the surface's point nearest to p.
    int region(const Vec3 &p, const Foot &foot) const;
    /// The same where that point is not known; `hint`: a triangle of the surface near p, -1 if there is none.
    int region(const Vec3 &p, int hint) const;
    /// The input tet that contains p; tet = -1 if none does.
    Place find(const Vec3 &p) const;
    /// As find, else the nearest point of the input's boundary.
    Place find_or_nearest(const Vec3 &p) const;

  private:
    struct SurfaceFacet {
        Facet corner;
        int tet;
        int opposite;
    };
    const InputMesh &mesh_;
    const Reference &reference_;
    geometry::BoxTree tets_;
    std::vector<double> volume_;       // per tet, six times
    std::vector<SurfaceFacet> facets_; // between different regions or to the outside
    geometry::BoxTree surface_;
    /// Per facet the square of the width of the strip where the surface decides: twice as far as the facet's corners
    /// and its center are from the surface.
    std::vector<double> strip_;
    std::vector<double> widest_; // per node of their tree the smallest of -strip_
};

} // namespace wct::domain
