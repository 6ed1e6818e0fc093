#pragma once

#include "domain/reference.h"
#include "sampling/cloud.h"
#include "sampling/restricted_delaunay.h"

namespace wct::sampling {

/// Patches must be made of facets: where an edge passes through one, facets beside it cut across to another. Where the
/// edge ends at a point close to the patch that point goes; elsewhere the patch, or a crease of it nearby, gets a point
/// where the edge passes. Returns the number of points that came or went.
int recover_patches(Cloud &cloud, const domain::Reference &reference, const RestrictedDelaunay &complex,
                    const Workers &workers);

} // namespace wct::sampling
