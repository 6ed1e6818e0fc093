#pragma once

#include "geometry/box_tree.h"
#include "geometry/circumspheres.h"

#include <optional>
#include <vector>

namespace wct::geometry {

/// The smallest ball through a facet's corners that holds no point, if there is one with some room. `smallest` of all
/// goes through them; the centers of the others are x times the unit normal n from its own, and points rule out those
/// with x below `lo` and above `hi`.
std::optional<Sphere> protecting_ball(const Sphere &smallest, const Vec3 &n, double lo, double hi);

/// Balls that points are to stay out of, so that what they protect is in the Delaunay triangulation.
class ProtectingBalls {
  public:
    ProtectingBalls() = default;
    explicit ProtectingBalls(std::vector<Sphere> balls);

    bool contains(const Vec3 &p) const { return deepest(p).ball >= 0; }
    /// Move p out of the balls, `onto(p)` putting it where it belongs after each step; false where that fails.
    template <class Onto> bool clear(Vec3 &p, const Onto &onto) const {
        constexpr int tries = 12;
        constexpr double out = 1.0 + 1e-4;
        constexpr double middle = 1e-3; // from where no way out is the nearest
        for (int k = 0; k < tries; ++k) {
            const Depth at = deepest(p);
            if (at.ball < 0)
                return true;
            if (at.share < middle)
                return false;
            const Vec3 &center = balls_[at.ball].center;
            p = center + (out / at.share) * (p - center);
            onto(p);
        }
        return false;
    }

  private:
    struct Depth {
        int ball = -1;
        double share = 1.0; // of the radius, from the center
    };
    Depth deepest(const Vec3 &p) const;

    std::vector<Sphere> balls_;
    BoxTree tree_;
};

} // namespace wct::geometry
