#pragma once

#include "base/parallel.h"
#include "domain/reference.h"
#include "domain/region_map.h"
#include "domain/sizing.h"

namespace wct::sampling {

/// How many tets a start of these sizes will have, about: those of the lattice that follows them, over the input's
/// tets. What sizes are given up later, as facets turn out to be off the tolerance, is not foreseen. The same number at
/// any number of threads.
double estimate_tets(const domain::Reference &reference, const domain::InputMesh &mesh, const domain::Sizing &sizing,
                     const Workers &workers);

} // namespace wct::sampling
