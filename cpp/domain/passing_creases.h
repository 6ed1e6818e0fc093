#pragma once

#include "domain/reference.h"

#include <span>
#include <vector>

namespace wct::domain {

/// Per vertex of the surface the distance at which its creases pass another crease, or a patch, if that is less than
/// the vertex's `reach`; else infinite. A crease does not pass what it meets: what has one of its patches, or one of
/// its vertices, or is a patch next to one of its own.
std::vector<double> passing_distances(const Reference &reference, std::span<const double> reach);

} // namespace wct::domain
