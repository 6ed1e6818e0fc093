#pragma once

#include "domain/reference.h"
#include "domain/region_map.h"
#include "domain/sizing.h"
#include "sampling/cloud.h"

#include <span>

namespace wct::sampling {

/// Points round the corners of a cloud that has points on its curves: where two creases enclose a wide angle of a
/// patch, a facet from one to the other is not acute, so each such angle is divided by patch points as far from the
/// corner as its creases' nearest points are. Creases at a sharp angle get their nearest points at one distance. At
/// layers, where three creases are square to each other, as at a cube's corner, the points are those round the corner
/// of the cube that is known to have well-centered tets, one inside among them: else the tet with three right angles
/// comes there. `divided`: points, ascending, of corners that have theirs already.
void seed_corners(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
                  const domain::Sizing &sizing, std::span<const int> divided);

} // namespace wct::sampling
