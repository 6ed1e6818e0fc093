#pragma once

#include "base/cells.h"
#include "base/vec3.h"
#include "search/tet_complex.h"

#include <span>
#include <vector>

namespace wct::search {

/// Per vertex of a mesh the needle of Vertex: at creases where a region fills a small angle, no tet has a larger one.
std::vector<double> needle_cosines(std::span<const Vec3> points, std::span<const Tet> tets,
                                   std::span<const int> regions, std::span<const Edge> creases);

} // namespace wct::search
