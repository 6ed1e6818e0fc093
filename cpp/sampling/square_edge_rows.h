#pragma once

#include "domain/region_map.h"
#include "domain/sizing.h"
#include "sampling/cloud.h"

#include <vector>

namespace wct::sampling {

/// Put rows of points round creases that patches leave at quarters of a turn, where the surface has interfaces, for a
/// cloud that has the points of its curves: the vertices of the body-centred lattice round one of its longer edges,
/// four tets to a step, one in each quarter. At corners where all creases are square to each other they begin with the
/// same points in every octant. Points of the rows and of the crease stay where they are in the relaxation.
///
/// Each facet at an edge of a well-centered mesh has its third corner between the planes that are square to the edge at
/// its ends. On every patch that meets at a crease there is one such corner per step, and a tet that fills a quarter
/// comes right only if its two are about as far along. Where several regions meet, relaxation finds that by luck alone.
/// Returns the corners, ascending.
std::vector<int> seed_square_rows(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
                                  const domain::Sizing &sizing);

} // namespace wct::sampling
