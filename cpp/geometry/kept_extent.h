#pragma once

#include <algorithm>

namespace wct::geometry {

/// The extent from which on planes and lines of a surface of this diagonal are kept exactly: in tolerances, as smaller
/// ones may turn by two degrees in the tolerance, or as a share of the whole surface's, so that a generous tolerance
/// leaves those that make its shape.
inline double kept_extent(double diagonal, double tolerance) {
    constexpr double kKept = 28.0;
    constexpr double kShape = 0.03;
    return std::min(kKept * tolerance, kShape * diagonal);
}

} // namespace wct::geometry
