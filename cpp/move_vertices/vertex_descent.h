#pragma once

#include "base/monitor.h"
#include "move_vertices/boundary_domain.h"
#include "move_vertices/moving_mesh.h"
#include "move_vertices/objective.h"

#include <cstdint>
#include <span>

namespace wct::move_vertices {

/// Move the given free points one after the other, each downhill in the energy of its own star by a few steps of BFGS
/// in three unknowns, `sweeps` times over. Gets on where the energy's kinks jam a descent of all points together.
/// Every step lowers the energy and keeps it finite. Returns the number of moves of the last sweep.
std::size_t relocate(MovingMesh &mesh, BoundaryDomain &domain, const Objective &objective,
                     std::span<const std::int32_t> points, int sweeps, Monitor &monitor);

} // namespace wct::move_vertices
