#pragma once

#include "delaunay/delaunay.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>

namespace wct::tests {

/// Each tet has, across a facet that is not on the hull, one that shares the facet and has it back once.
inline void check_neighbours(const delaunay::Triangulation &made) {
    for (std::size_t k = 0; k < made.tets.size(); ++k) {
        const Tet &tet = made.tets[k];
        for (int i = 0; i < 4; ++i) {
            const int other = made.neighbours[k][i];
            if (other < 0)
                continue;
            int shared = 0;
            for (const int v : made.tets[static_cast<std::size_t>(other)])
                shared += v != tet[i] && std::count(tet.begin(), tet.end(), v) == 1;
            REQUIRE(shared == 3);
            const auto &back = made.neighbours[static_cast<std::size_t>(other)];
            REQUIRE(std::count(back.begin(), back.end(), static_cast<int>(k)) == 1);
        }
    }
}

} // namespace wct::tests
