#pragma once

#include "domain/region_map.h"
#include "domain/sizing.h"
#include "sampling/cloud.h"
#include "sampling/partial_renewal.h"

#include <optional>

namespace wct::sampling {

/// Put a row of interior points along each outer edge at which a region, one without interfaces and sheets, fills about
/// a right angle: one for each point of the crease, half-way between the sides and as far from it as the next point.
///
/// With points of the sides half-way between those of the crease, as in a triangular pattern, all tets at the crease
/// are completely well-centered then. Without a row there are none such: where the link of a crease point is the six
/// points round it on the two sides, four of those make two tets of a quadrilateral that is nearly a rectangle.
void seed_square_rows(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
                      const domain::Sizing &sizing, const std::optional<PartialRenewal> &renewal);

} // namespace wct::sampling
