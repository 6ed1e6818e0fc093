#pragma once

#include "base/cells.h"
#include "domain/reference.h"

#include <vector>

namespace wct::domain {

/// A point of a sharp edge.
struct SharpFoot {
    Vec3 point;
    int edge = -1;      // of SharpEdges; -1: none is near enough
    double along = 0.0; // from its first end, 0 to 1
    double distance = 0.0;
};

/// Creases where a region fills an angle of less than 60 degrees, between two facets of its boundary.
///
/// Every tet at such an edge has that angle there, so it is well-centered only where its edge along the crease is about
/// as long as the region is thick at its two other vertices. The first vertices off the crease therefore belong where
/// the region is as thick as the edges along it are long: between them and the crease there is to be none.
class SharpEdges {
  public:
    /// `outside`: those where it is no region that is so narrow, but what is outside of all; where interfaces end there
    /// are regions beside it all the same.
    explicit SharpEdges(const Reference &reference, bool outside = false);

    bool empty() const { return edges_.empty(); }
    /// The nearest point of one that is nearer than `most`.
    SharpFoot nearest(const Vec3 &p, double most) const;
    /// Vertices of the reference at its ends.
    const Edge &ends(int edge) const { return edges_[edge].ends; }
    /// How thick the region is at the distance 1 from it.
    double narrow(int edge) const { return edges_[edge].narrow; }
    /// Whether a point, whose nearest point of it this is, lies in the angle or on its sides; always where nothing else
    /// meets there.
    bool takes_in(const SharpFoot &foot, const Vec3 &p) const;
    /// The triangles on either side.
    const std::array<int, 2> &beside(int edge) const { return edges_[edge].beside; }
    int count() const { return static_cast<int>(edges_.size()); }
    /// Whether any edge of a curve is sharp.
    bool of_curve(int curve) const { return curves_[curve]; }

  private:
    struct SharpEdge {
        Edge ends;
        std::array<int, 2> beside;
        double narrow;
        bool shared; // with other facets
        Vec3 middle; // of the angle: the unit vector from the edge
        double half; // of the angle, in radians
    };

    const Reference &reference_;
    std::vector<SharpEdge> edges_;
    std::vector<char> curves_;
    geometry::BoxTree tree_;
};

} // namespace wct::domain
