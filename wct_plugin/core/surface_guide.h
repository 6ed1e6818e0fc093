#pragma once

#include "bounding_tree.h"
#include "tet_complex.h"

#include <vector>

namespace wct {

/// The surface the boundary and the interfaces must stay near, cut into patches and curves: where a vertex may be, and
/// which facets and crease edges are near enough. Planar patches and straight curves are kept exactly; on curved ones
/// vertices are free in a shell round the surface, so that facets can cut through it and keep the volume.
class SurfaceGuide {
  public:
    /// `patch` and `curve` number from 0. `tolerance` is a length; vertices of curved patches stay within `shell` of
    /// the surface, facets within `tolerance`.
    SurfaceGuide(const std::vector<Vec3> &points, const std::vector<Facet> &triangles, const std::vector<int> &patch,
                 const std::vector<Edge> &segments, const std::vector<int> &curve, double tolerance, double shell);

    /// Put x where the vertex may be. False: it may not move at all. `direction`: unit normal of a planar patch or unit
    /// tangent of a crease; zero where all directions are free.
    bool admit(const Vertex &vertex, Vec3 &x, Vec3 *direction = nullptr) const;
    /// Where the sample points of a facet were last found near the surface: the next search begins there.
    static constexpr int kSamples = 13;
    using Hints = std::array<std::int32_t, kSamples>;

    double tolerance() const { return tolerance_; }
    /// Whether a facet of the patch with these corners stays within the tolerance and is not folded over.
    bool allows(int patch, const Vec3 &p, const Vec3 &q, const Vec3 &r) const;
    /// The same with another limit than the tolerance.
    bool within(int patch, const Vec3 &p, const Vec3 &q, const Vec3 &r, double limit, Hints &hints) const;
    /// Greatest distance of sample points of the facet from the patch.
    double deviation(int patch, const Vec3 &p, const Vec3 &q, const Vec3 &r) const;
    bool allows_crease(int curve, const Vec3 &p, const Vec3 &q) const;

  private:
    struct Patch {
        BoundingTree<3> tree;
        bool planar = false;
        Vec3 normal, origin;
    };
    struct Curve {
        BoundingTree<2> tree;
        bool straight = false;
        Vec3 direction, origin;
    };
    std::vector<Patch> patches_;
    std::vector<Curve> curves_;
    double tolerance_;
    double shell_;
};

} // namespace wct
