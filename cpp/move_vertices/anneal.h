#pragma once

#include "base/monitor.h"
#include "move_vertices/boundary_domain.h"
#include "move_vertices/moving_mesh.h"

#include <cstdint>
#include <span>

namespace wct::move_vertices {

enum class Goal { well_centered, completely_well_centered };

/// Least value of h/R (and of the cosines, where they matter) that the search takes for positive: far above rounding.
inline constexpr double kClear = 1e-6;

/// How the search goes: the temperature falls from `hot` to `cold`, geometrically; then it is zero for the last
/// twentieth.
struct Annealing {
    double hot = 0.4;
    double cold = 0.02;
    double start = 0.0; // where on its course to begin: 0 melts what came in, nearer to 1 keeps most of it
    double near = 0.02; // cost of a tet that misses all of its margin; missing the goal costs at least 0.5
    int sweeps = 2000;
    std::uint64_t seed = 1;
};

/// Search for positions where as many tets as possible meet the goal, by simulated annealing over single points.
///
/// Descent of a smooth energy stalls far from the most tets it could serve, since it spends itself on those that no
/// position can serve. This search lets such tets go: the cost of a tet with worst value z (its smallest h/R, or the
/// smaller of that and its smallest cosine) is
///
///   slope * min(max(0, -z), width)  +  step [z <= kClear]  +  near * min(max(0, margin - z), margin) / margin
///
/// which saturates below -width. Over the run it turns from a wide ramp without a step, which leads tets back, to a
/// narrow one with it, which counts them.
///
/// No tet turns inside out or becomes flatter than the mesh allows. Only the given points move. The positions it ends
/// at are usually the best of the run but need not be: the caller compares.
void anneal(MovingMesh &mesh, BoundaryDomain &domain, Goal goal, double margin, const Annealing &annealing,
            std::span<const std::int32_t> points, Monitor &monitor);

} // namespace wct::move_vertices
