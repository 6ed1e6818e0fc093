#pragma once

#include "bvh.h"
#include "vec3.h"

#include <algorithm>
#include <vector>

namespace wct {

/// The extent from which on planes and lines of a surface with these points are kept exactly: in tolerances, as smaller
/// ones may turn by two degrees in the tolerance, or as a share of the whole surface's, so that a generous tolerance
/// leaves those that make its shape.
inline double kept_extent(const std::vector<Vec3> &points, double tolerance) {
    constexpr double kKept = 28.0;
    constexpr double kShape = 0.03;
    Box box;
    for (const Vec3 &p : points)
        box.add(p);
    return std::min(kKept * tolerance, kShape * norm(box.hi - box.lo));
}

} // namespace wct
