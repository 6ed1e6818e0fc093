#pragma once

#include "base/monitor.h"
#include "energy/lbfgs.h"
#include "move_vertices/boundary_domain.h"
#include "move_vertices/moving_mesh.h"
#include "move_vertices/objective.h"

namespace wct::move_vertices {

using energy::Outcome;

/// Move all free points of the mesh at once downhill by L-BFGS (Nocedal 1980) with memory 10, retracting boundary
/// points to their patch or crease at each step. Points that the domain watches stay: they move one by one only, which
/// costs nothing in what a search that follows reaches (measured).
///
/// Every accepted step has a finite energy, so no tet turns inside out, and lowers it. `jammed` means that no step
/// along the steepest descent lowers it: the energy has a kink there, or the mesh starts at an infinite energy.
Outcome descend(MovingMesh &mesh, BoundaryDomain &domain, const Objective &objective, int iterations, Monitor &monitor);

} // namespace wct::move_vertices
