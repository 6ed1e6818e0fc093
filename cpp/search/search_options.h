#pragma once

#include "base/parallel.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace wct::search {

struct SearchOptions {
    bool acute = true;    // aim at CWC; otherwise at 3WC alone
    double margin = 0.02; // clearance in h/R and cosine aimed at once all tets meet the goal
    bool flip_surface = true;
    bool split_surface = true;
    std::vector<std::uint8_t> fixed, fixed_curves; // patches and curves that stay, as of Operators
    int passes = 12;                               // greatest number of sweeps over all tets that fall short
    long kicks = 4000;  // tries of the iterated local search in vain after which it stops; fewer where much is bad
    bool hurry = false; // whether it should stop soon where the goal is not reached: there are other ways to go on
    /// Evaluations per tet of the mesh that getting rid of all bad tets is worth: kicks stop where it would take more.
    double worth = std::numeric_limits<double>::infinity();
    /// Work, as of WorkUnits, after which kicks end, whatever is left.
    long work = std::numeric_limits<long>::max();
    /// Tets that the mesh may grow to.
    std::size_t most = std::numeric_limits<std::size_t>::max();
    double crease = -1.0; // cosine of the angle by which creases bend, as of SurfaceWatch
    std::uint64_t seed = 0;
    Workers workers;             // the same comes out whatever their number
    std::vector<double> volumes; // that the regions are to have in the end, by number; none: any
};

} // namespace wct::search
