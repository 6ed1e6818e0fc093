#pragma once

#include "sampling/resample.h"
#include "sampling/surface_labels.h"
#include "search/stratified_mesh.h"

#include <vector>

namespace wct::sampling {

/// What is inside of a resampled domain: the mesh that a search starts from.
struct Start {
    search::StratifiedMesh mesh;
    std::vector<int> place; // per point of the cloud its row in the mesh, -1 where no tet inside has it
};
Start start_of(const Resampled &result, const SurfaceLabels &surface);

} // namespace wct::sampling
