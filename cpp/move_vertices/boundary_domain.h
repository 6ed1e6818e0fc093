#pragma once

#include "base/vec3.h"
#include "geometry/landmark_owners.h"
#include "geometry/piece_tree.h"
#include "move_vertices/problem.h"

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <variant>
#include <vector>

namespace wct::move_vertices {

/// The boundary as it was at the start, and for each point the part of it that the point stays on: patch points on the
/// triangles of their patch, crease points on the segments of their curve. A flat patch is its plane and a straight
/// crease its line, so that points stay on them to rounding however often they move.
///
/// Points on a curved patch do not keep its facets on it. So the domain also keeps watch that the facets, as they lie
/// now, and their patch, as it lay at the start, stay within the tolerance of each other, and likewise the segments of
/// a curved crease and its curve.
class BoundaryDomain {
  public:
    /// Throws std::invalid_argument where a point's patch or curve has no piece. No watch is kept with an infinite
    /// tolerance.
    BoundaryDomain(const Problem &problem, double tolerance);

    bool moves(std::int32_t point) const { return where(point) != kFixed; }

    /// The allowed position closest to x.
    Vec3 retract(std::int32_t point, const Vec3 &x);

    /// The part of v along which the point may move from x, an allowed position.
    Vec3 tangential(std::int32_t point, const Vec3 &x, const Vec3 &v);

    /// Does a move of the point need to be admitted?
    bool watches(std::int32_t point) const { return !watched(point).empty(); }

    /// May the point, which has just moved to where it is in `points`, stay there? Every move since the start must have
    /// been asked for, one by one, and been taken back where it was refused.
    bool admit(std::int32_t point, std::span<const Vec3> points);

    /// Remember the positions admitted last, and return to those remembered (at first those of the start).
    void keep() { kept_ = covered_; }
    void restore() { covered_ = kept_; }

  private:
    struct Plane {
        Vec3 origin;
        Vec3 normal;
    };
    struct Line {
        Vec3 origin;
        Vec3 direction;
    };
    using Support = std::variant<Plane, Line, geometry::PieceTree<3>, geometry::PieceTree<2>>;

    static constexpr std::int32_t kInterior = -1;
    static constexpr std::int32_t kFixed = -2;

    /// A facet, an edge of facets of one patch, or a segment of a curve.
    struct Watched {
        std::array<std::int32_t, 3> corners; // the last is -1 where there are two
        std::int32_t support;
        bool covers;                        // whether its support's vertices are watched from it: not from edges
        std::array<std::int32_t, 4> last{}; // the piece that each sample was last found near
    };

    std::int32_t where(std::int32_t point) const { return where_[static_cast<std::size_t>(point)]; }
    const Support &support(std::int32_t point) const { return supports_[static_cast<std::size_t>(where(point))]; }

    std::span<const std::int32_t> watched(std::int32_t point) const {
        const auto p = static_cast<std::size_t>(point);
        return {stars_.data() + offsets_[p], stars_.data() + offsets_[p + 1]};
    }
    using Known = std::set<std::array<std::int32_t, 2>>; // support, point: what landmarks there are already
    /// Find what is to be watched: all that has a corner that moves, and a patch or curve that is not flat or straight.
    void watch(const Problem &problem, std::map<std::int64_t, std::int32_t> &patches,
               const std::map<std::int64_t, std::int32_t> &curves);
    bool any_moves(std::span<const std::int32_t> corners) const;
    bool curved(std::int32_t support) const;
    /// Supports of patches that have no moving point of their own, but moving creases.
    void support_creases(const Problem &problem, std::map<std::int64_t, std::int32_t> &patches);
    /// Watch it, and the vertices of its support that it is the first to have as corners, if it covers any.
    void add_watched(const Watched &watched, const Problem &problem, Known &known);
    /// List per point what is watched at it.
    void list_watched();
    bool sample_near(Watched &watched, std::size_t sample, const Vec3 &x) const;
    bool middle_near(Watched &watched, std::span<const Vec3> points) const;
    bool rest_near(Watched &watched, std::span<const Vec3> points) const;
    bool covers(std::int32_t watched, const Vec3 &place, std::span<const Vec3> points) const;
    std::int32_t cover(std::int32_t first, const Vec3 &place, std::int32_t point, std::span<const Vec3> points) const;

    static Support support_of(std::vector<std::array<Vec3, 3>> triangles);
    static Support support_of(std::vector<std::array<Vec3, 2>> segments);

    std::vector<std::int32_t> where_; // index of a support, or one of the constants
    std::vector<std::int32_t> last_;  // the piece each point was last found on: where the next search for it begins
    std::vector<Support> supports_;

    double tolerance_;
    double limit_; // squared distance of the places that are looked at
    std::vector<Watched> watched_;
    std::vector<std::size_t> offsets_; // per point: what of watched_ it is a corner of
    std::vector<std::int32_t> stars_;
    std::vector<Vec3> landmarks_; // vertices of the surface at the start, once for each of their patches and curves
    /// What of the watched has each landmark near it.
    struct Covered {
        geometry::LandmarkOwners<std::int32_t> owners;
        std::vector<int> first; // per watched: of its landmarks
    };
    Covered covered_;
    Covered kept_;
    std::vector<std::array<std::int32_t, 2>> handed_; // landmark, and to whom it goes if a move is admitted
};

} // namespace wct::move_vertices
