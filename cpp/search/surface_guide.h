#pragma once

#include "geometry/piece_tree.h"
#include "geometry/plane.h"
#include "search/tet_complex.h"

#include <array>
#include <map>
#include <optional>
#include <vector>

namespace wct::search {

/// Which way a vertex may move: along all of space, a plane (axis: its unit normal) or a line (its unit direction).
struct Freedom {
    enum class Kind : std::uint8_t { space, plane, line } kind = Kind::space;
    Vec3 axis;

    /// What is left of v.
    Vec3 of(const Vec3 &v) const {
        return kind == Kind::space ? v : kind == Kind::line ? dot(v, axis) * axis : v - dot(v, axis) * axis;
    }
};

/// The surface the boundary and the interfaces must stay near, cut into patches and curves: where a vertex may be, and
/// which facets are near enough. Planar patches and straight curves are kept exactly, unless they are so small that the
/// tolerance lets them turn. On curved patches vertices are free in a shell round the surface, so that facets can cut
/// through it and keep the volume, and on curved creases in a tube (in the plane of the planar patch at the crease, if
/// there is one). Corners where nothing is kept exactly are free in a ball.
class SurfaceGuide {
  public:
    struct Surface {
        const std::vector<Vec3> &points;
        const std::vector<Facet> &triangles;
        const std::vector<int> &patch; // of each triangle, from 0
        const std::vector<Edge> &segments;
        const std::vector<int> &curve;    // of each segment, from 0
        double flat;                      // as far off a plane or line vertices may be where they count as on it
        const std::vector<double> &local; // the tolerance at each point, where it is less in places; empty: it is not
    };
    /// `tolerance` is a length. Landmarks on edges of the surface are no farther apart than `spacing`.
    SurfaceGuide(const Surface &surface, double tolerance, double spacing);

    /// Whether the vertex may move at all.
    bool moves(const Vertex &vertex) const {
        return vertex.stratum != Stratum::corner || corners_.contains(vertex.label);
    }
    /// Put x where the vertex, which moves, may be and say how it may go on from there. `hint` is where the surface was
    /// found last, the vertex's own at first.
    Freedom admit(const Vertex &vertex, Vec3 &x, std::int32_t &hint) const;
    Freedom admit(const Vertex &vertex, Vec3 &x) const {
        std::int32_t hint = vertex.hint;
        return admit(vertex, x, hint);
    }

    double tolerance() const { return tolerance_; }
    std::size_t patches() const { return patches_.size(); }
    bool planar(int patch) const { return patches_[patch].planar; }
    bool straight(int curve) const { return curves_[curve].straight; }
    /// Of all the surface's triangles in the patch.
    double area(int patch) const { return patches_[patch].area; }
    /// Whether the curve is kept exactly, or a planar patch beside it.
    bool exact(int curve) const { return curves_[curve].straight || curves_[curve].plane; }

    /// Whether all of a facet of a curved patch is within the tolerance of it and not folded over. Bit k of `edges`
    /// says that the edge from corner k to the next is to be looked at along its whole length; the others are known to
    /// be near.
    bool near(int patch, const std::array<Vec3, 3> &corners, unsigned edges, SurfaceHints &hints) const;
    /// How far a facet is from its patch, as found at sample points: the farthest of them, in weights of the corners,
    /// and the vector from there to the surface.
    struct Gap {
        double distance = 0.0; // as strict times farther, to be compared with the tolerance
        Vec3 weights, to_surface;
        double strict = 1.0; // the tolerance over the one at the place
    };
    /// No farther sample is looked for once one is farther than `enough`.
    Gap gap(int patch, const std::array<Vec3, 3> &corners, SurfaceHints &hints,
            double enough = std::numeric_limits<double>::infinity()) const;
    /// Mean signed distance of the facet from its patch, in front of the patch's triangles positive.
    double offset(int patch, const std::array<Vec3, 3> &corners, const SurfaceHints &hints) const;
    /// Signed distance of x from the patch, in front of its triangles positive. `guess`: a piece nearby.
    double height(int patch, const Vec3 &x, std::int32_t guess) const;
    /// Unit normal of the patch where it is closest to x.
    Vec3 normal(int patch, const Vec3 &x, std::int32_t guess) const;
    /// Unit normal of one of its pieces, as hints number them.
    Vec3 normal(int patch, std::int32_t piece) const { return unit(normal_of(patches_[patch].tree.pieces()[piece])); }
    /// Whether the edge pq is near the curve: the same answer for qp, or what one end is allowed would not bind the
    /// other, and within rounding of the tolerance the edge would be held no more.
    bool allows_crease(int curve, const Vec3 &p, const Vec3 &q) const;
    /// How far the edge pq is from the curve, as found at some places.
    double crease_gap(int curve, const Vec3 &p, const Vec3 &q) const;
    /// Whether the curve bends and no curved patch is beside it, as round a flat sheet and along a wire: then no facet
    /// that is held near its patch holds the crease near the curve.
    bool bare(int curve) const { return curves_[curve].bare; }

    /// Points of the surface that facets must stay near, too: vertices of curved patches, and points on edges where
    /// they bend.
    struct Landmark {
        Vec3 point;
        int patch;
        bool joined; // to the next one, by a straight edge
        double tolerance;
    };
    /// The tolerance over the one at the landmark.
    double strict(int landmark) const { return tolerance_ / landmarks_[landmark].tolerance; }
    const std::vector<Landmark> &landmarks() const { return landmarks_; }
    /// Whether the facet is within the tolerance of the landmark.
    bool covers(const std::array<Vec3, 3> &corners, int landmark) const {
        const Vec3 &point = landmarks_[landmark].point;
        return covers(point - geometry::closest_on(corners, point), landmark);
    }
    bool covers(const std::array<Vec3, 3> &corners, const geometry::TriangleFrame &frame, int landmark) const {
        const Vec3 &point = landmarks_[landmark].point;
        return covers(point - geometry::closest_on(corners, frame, point), landmark);
    }

  private:
    /// Landmarks: what is between them may be a little farther.
    static constexpr double kCovered = 0.94;
    bool covers(const Vec3 &off, int landmark) const {
        const double most = kCovered * landmarks_[landmark].tolerance;
        return dot(off, off) <= most * most;
    }

    struct Patch {
        geometry::PieceTree<3> tree;
        bool planar = false;
        geometry::Plane plane;
        double area = 0.0;
        std::vector<double> local; // tolerance per piece of the tree; empty: all the same
        /// The least of those at pieces that may be nearest to what is within the tolerance of this one: what it
        /// surely is there, wherever the nearest is.
        std::vector<double> surely;
    };
    struct Curve {
        geometry::PieceTree<2> tree;
        bool straight = false;
        bool bare = false;
        bool parting = false; // between two facets of curved patches, all along
        Vec3 direction, origin;
        std::optional<geometry::Plane> plane; // of the planar patch at the curve
        double tolerance = 0.0;               // the least along it
    };
    /// Put x where a vertex of the patch or curve may be; returns how it may go on from there.
    Freedom admit_on(const Patch &patch, Vec3 &x, std::int32_t &hint) const;
    Freedom admit_on(const Curve &curve, Vec3 &x, std::int32_t &hint) const;
    double tolerance_at(const Patch &patch, std::int32_t piece) const {
        return patch.local.empty() ? tolerance_ : patch.local[piece];
    }
    double surely_at(const Patch &patch, std::int32_t piece) const {
        return patch.surely.empty() ? tolerance_ : patch.surely[piece];
    }
    /// Whether a sample of a facet is near the patch. `least` comes down to the tolerance of the piece it is near.
    bool sample_near(const Patch &patch, const Vec3 &x, std::int32_t &hint, double &least) const;
    void make_patches(const Surface &surface);
    void make_curves(const Surface &surface);
    void make_corners(const Surface &surface);
    void make_landmarks(const Surface &surface, double spacing);

    std::vector<Patch> patches_;
    std::vector<Curve> curves_;
    std::map<int, Vec3> corners_; // by point of the surface: those on creases that may move if they are corners
    std::vector<Landmark> landmarks_;
    double tolerance_;
    double diagonal_ = 0.0;
    std::map<int, double> at_corners_; // the tolerance there
};

} // namespace wct::search
