#pragma once

#include "domain/reference.h"
#include "domain/sizing.h"
#include "sampling/cloud.h"
#include "sampling/restricted_delaunay.h"

#include <vector>

namespace wct::sampling {

/// Points where the domain is not represented, but for corners: sheets of the input itself may touch there.
std::vector<int> lost_points(const Cloud &cloud, const Flaws &flaws);

/// Points where planes are not represented: facets cut across from one to another, or creases beside them have gaps.
std::vector<int> lost_planes(const Cloud &cloud, const RestrictedDelaunay &complex, const domain::Reference &reference,
                             const domain::SizingForm &sizing);

/// Corners, three each, of facets whose two sides no patch of the reference parts. Where a part is thinner than edges
/// are long, what lies on both sides of it meets through it.
std::vector<int> strange_contacts(const RestrictedDelaunay &complex, const domain::Reference &reference);

} // namespace wct::sampling
