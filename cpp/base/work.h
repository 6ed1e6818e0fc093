#pragma once

namespace wct {

/// Work is counted in evaluations of a tet's energy, of which 15 take about a microsecond, so that what ends for having
/// worked enough gives the same result on any machine. Other things that take long cost as many of them:
struct WorkUnits {
    static constexpr long look = 20;   // whether a facet of a curved patch is near its surface
    static constexpr long sweep = 120; // a sweep of relaxation, per point
    static constexpr long round = 400; // triangulating anew and a descent of all points, per point
};

} // namespace wct
