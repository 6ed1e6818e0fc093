#pragma once

#include "domain/reference.h"
#include "sampling/cloud.h"
#include "sampling/restricted_delaunay.h"

namespace wct::sampling {

/// Give tets at pinched points to a region beside them, until the surface is a disk at every point or no such change
/// brings it nearer to that; returns the flaws that are left.
///
/// Where sheets come closer to each other than their points, or cross a tight bend, a few tets end up on the wrong side
/// and the surface touches itself along an edge or at a point. Corners where sheets of the reference itself touch stay.
Flaws mend_pinches(const Cloud &cloud, const domain::Reference &reference, RestrictedDelaunay &complex, Flaws flaws);

} // namespace wct::sampling
