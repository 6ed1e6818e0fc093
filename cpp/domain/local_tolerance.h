#pragma once

#include "base/parallel.h"
#include "domain/reference.h"

#include <vector>

namespace wct::domain {

/// Per point of the surface, how far a mesh may be from it there: `most`, but no more than a tenth of the wall or the
/// gap there, or of the radius where the surface bends round it, and no less than `floor`.
///
/// Walls and gaps are measured along the normal, from one facet to another that faces it and is nearly parallel; where
/// the two meet at a sharp edge there is neither. Along the surface the tolerance grows slowly from where it is small.
std::vector<double> local_tolerance(const Reference &reference, double most, double floor, const Workers &workers);

} // namespace wct::domain
