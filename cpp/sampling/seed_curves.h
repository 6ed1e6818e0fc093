#pragma once

#include "domain/reference.h"
#include "domain/sizing.h"
#include "sampling/cloud.h"

namespace wct::sampling {

/// Points on the curves, each an edge length from the next; those at corners that must be kept are held.
void seed_curves(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing);

} // namespace wct::sampling
