#pragma once

#include "sampling/curve_chains.h"

#include <map>
#include <vector>

namespace wct::sampling {

/// Angles that are so far off a right one count as right: 15 degrees, in radians.
inline constexpr double kSquare = 0.26;

/// Where a crease leaves a corner.
struct Spoke {
    int curve;
    int next;   // point on it
    int steps;  // of the crease
    bool moves; // whether that may be put elsewhere
    Vec3 way;
    double length;
};

/// The creases at corners where all are square to each other or in one line and have room, by the corner's point. Their
/// first steps are made about as long as the shortest of them is.
std::map<int, std::vector<Spoke>> square_corners(Cloud &cloud, const domain::Reference &reference,
                                                 const std::vector<std::vector<CurveStop>> &chains);

/// Whether one leaves that way.
bool is_crease(const std::vector<Spoke> &spokes, const Vec3 &way);

/// How long the first step is that way, or the opposite way where no crease goes there; else `other`.
double first_step(const std::vector<Spoke> &spokes, const Vec3 &way, double other);

} // namespace wct::sampling
