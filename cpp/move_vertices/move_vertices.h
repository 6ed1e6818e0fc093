#pragma once

#include "base/monitor.h"
#include "move_vertices/anneal.h"
#include "move_vertices/problem.h"
#include "move_vertices/verdict.h"

#include <limits>

namespace wct::move_vertices {

struct Aim {
    Goal goal = Goal::well_centered;
    double margin = 0.02; // wanted in h/R, and in the cosines if the goal asks
    int effort = 1;       // multiplies the iterations
    /// Greatest distance, both ways, between a curved surface now and at the start.
    double tolerance = std::numeric_limits<double>::infinity();
};

struct Result {
    std::vector<Vec3> points;
    Verdict before;
    Verdict after;
};

/// Move the free points of a mesh, whose tets are all positive, so that more tets meet the goal.
///
/// Whatever happens, the result has no inverted tet, no fewer well-centered tets than came in, and the bits of every
/// point that does not move; where nothing better was found it is the input. The same input gives the same bits.
/// Throws std::invalid_argument where a point is to stay on a patch or curve that has no piece.
Result well_center(const Problem &problem, const Aim &aim, Monitor &monitor);

} // namespace wct::move_vertices
