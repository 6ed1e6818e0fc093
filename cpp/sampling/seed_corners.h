#pragma once

#include "domain/reference.h"
#include "sampling/cloud.h"

namespace wct::sampling {

/// Points round the corners of a cloud that has points on its curves: where two creases enclose a wide angle of a
/// patch, a facet from one to the other is not acute, so each such angle is divided by patch points as far from the
/// corner as its creases' nearest points are. Creases at a sharp angle get their nearest points at one distance.
void seed_corners(Cloud &cloud, const domain::Reference &reference);

} // namespace wct::sampling
