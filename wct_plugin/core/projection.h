#pragma once

#include "bounding_tree.h"
#include "problem.h"
#include "vec3.h"

#include <cstdint>
#include <variant>
#include <vector>

namespace wct {

/// The boundary as it was at the start, and for each point the part of it that the point stays on: patch points on the
/// triangles of their patch, crease points on the segments of their curve. A flat patch is its plane and a straight
/// crease its line, so that points stay on them to rounding however often they move.
class Domain {
  public:
    /// Throws std::invalid_argument where a point's patch or curve has no piece.
    explicit Domain(const Problem &problem);

    bool moves(std::int32_t point) const { return where(point) != kFixed; }

    /// The allowed position closest to x.
    Vec3 retract(std::int32_t point, const Vec3 &x);

    /// The part of v along which the point may move from x, an allowed position.
    Vec3 tangential(std::int32_t point, const Vec3 &x, const Vec3 &v);

  private:
    struct Plane {
        Vec3 origin;
        Vec3 normal;
    };
    struct Line {
        Vec3 origin;
        Vec3 direction;
    };
    using Support = std::variant<Plane, Line, BoundingTree<3>, BoundingTree<2>>;

    static constexpr std::int32_t kInterior = -1;
    static constexpr std::int32_t kFixed = -2;

    std::int32_t where(std::int32_t point) const { return where_[static_cast<std::size_t>(point)]; }
    const Support &support(std::int32_t point) const { return supports_[static_cast<std::size_t>(where(point))]; }

    static Support support_of(std::vector<std::array<Vec3, 3>> triangles);
    static Support support_of(std::vector<std::array<Vec3, 2>> segments);

    std::vector<std::int32_t> where_; // index of a support, or one of the constants
    std::vector<std::int32_t> last_;  // the piece each point was last found on: where the next search for it begins
    std::vector<Support> supports_;
};

} // namespace wct
