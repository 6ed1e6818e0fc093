#pragma once

#include "domain/region_map.h"
#include "domain/sizing.h"
#include "sampling/cloud.h"

namespace wct::sampling {

/// Points half-way between the sides of walls that are no thicker than two layers of tets. The lattice inside has a
/// plane of points there only by luck, and without one tets reach from side to side, few of which come right.
///
/// The cloud has its points on patches, and inside those of the lattice, which these keep off. `cell_per_edge`: of the
/// lattice.
void seed_walls(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
                const domain::Sizing &sizing, double cell_per_edge, const Workers &workers);

} // namespace wct::sampling
