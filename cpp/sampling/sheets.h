#pragma once

#include "base/parallel.h"
#include "domain/reference.h"
#include "sampling/cloud.h"
#include "sampling/restricted_delaunay.h"

#include <vector>

namespace wct::sampling {

/// Sheets are patches inside a region. Its tets do not tell of them as they do of the boundary and of interfaces: a
/// facet is on a sheet if its corners are, the sheet runs there, and the tets beside it are on either side.
void find_sheets(const Cloud &cloud, const domain::Reference &reference, RestrictedDelaunay &complex,
                 const Workers &workers);

/// Corners of facets where a sheet has a hole, or three facets at an edge, or none along a curve of it. All of a sheet
/// is there where this is empty: what its facets cover can only end at the curves round it.
std::vector<int> torn_sheets(const Cloud &cloud, const domain::Reference &reference, const RestrictedDelaunay &complex);

/// Interior points whose edge to another passes through a sheet: the nearer of the two, ascending. Where such edges
/// are, facets of the sheet are not.
std::vector<int> piercing_points(const Cloud &cloud, const domain::Reference &reference,
                                 const RestrictedDelaunay &complex, const Workers &workers);

} // namespace wct::sampling
