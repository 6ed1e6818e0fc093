#pragma once

#include "sampling/curve_chains.h"

#include <map>
#include <vector>

namespace wct::sampling {

/// Angles that are so far off a right one count as right: 15 degrees, in radians.
inline constexpr double kSquare = 0.26;

/// The first step along a crease from a corner: its direction and length.
struct FirstStep {
    Vec3 way;
    double length;
};

/// Those along the creases at corners where all are square to each other or in one line and have room, by the corner's
/// point; they are made about as long as the shortest of a corner is.
std::map<int, std::vector<FirstStep>> square_corners(Cloud &cloud, const domain::Reference &reference,
                                                     const std::vector<std::vector<CurveStop>> &chains);

/// Whether one goes that way.
bool is_crease(const std::vector<FirstStep> &steps, const Vec3 &way);

/// How long the one that way is, or the opposite way where none goes there; else `other`.
double first_length(const std::vector<FirstStep> &steps, const Vec3 &way, double other);

} // namespace wct::sampling
