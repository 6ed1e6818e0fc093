#pragma once

#include "base/cells.h"
#include "delaunay/delaunay.h"

#include <span>

namespace wct::delaunay {

/// Four points on a circle in one plane have two Delaunay triangulations: swap their diagonal, on both sides of the
/// plane, where `wanted` facets (ascending) are on the other one. Returns how many were swapped.
int swap_diagonals(Triangulation &all, std::span<const Vec3> points, std::span<const Facet> wanted);

/// Swap them until the facets that `missing()` finds, ascending, are there, or none of them is to be had so.
template <class Missing> void recover_facets(Triangulation &all, std::span<const Vec3> points, const Missing &missing) {
    constexpr int rounds = 3; // a tet may be beside more than one square
    for (int round = 0; round < rounds; ++round)
        if (swap_diagonals(all, points, missing()) == 0)
            return;
}

} // namespace wct::delaunay
