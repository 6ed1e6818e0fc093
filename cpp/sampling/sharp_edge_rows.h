#pragma once

#include "domain/sizing.h"
#include "sampling/cloud.h"

namespace wct::sampling {

/// Put a row of points along the rim of each sharp edge's clearance on either side, for a cloud that has the points of
/// its curves: one per step along the crease, at a third of it and at two thirds. Crease and rows then run round each
/// other like the strands of a Boerdijk-Coxeter helix, whose tets are well-centered however thin the region is. Where
/// the angle is outside, rows that mirror each other follow as long as the sides are close: else facets on one side
/// would have the other's points in their spheres.
void seed_sharp_rows(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing);

/// Drop points of patches and of the inside that are well within the clearance of a sharp edge. See SharpEdges.
void clear_sharp(Cloud &cloud, const domain::Sizing &sizing);

/// Move those that are within it to its rim, where relaxation drew them in.
void keep_off_sharp(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing,
                    const Workers &workers);

} // namespace wct::sampling
