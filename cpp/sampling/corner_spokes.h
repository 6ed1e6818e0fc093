#pragma once

#include "sampling/curve_chains.h"

#include <map>
#include <vector>

namespace wct::sampling {

/// Where a crease leaves a corner.
struct Spoke {
    int curve;
    int point; // next on the curve
    int steps; // of the curve

    /// Whether the next point is no corner, nor the one next to that at the curve's other end.
    bool alone() const { return steps > 2; }
};

/// The creases at the corners, by the corner's point. `chains`: see curve_chains.
std::map<int, std::vector<Spoke>> spokes_of(const std::vector<std::vector<CurveStop>> &chains,
                                            const domain::Reference &reference);

/// Move the next point on a crease to a distance from the corner, unless it is given.
void put_at(Cloud &cloud, const domain::Reference &reference, int corner, const Spoke &spoke, double distance);

} // namespace wct::sampling
