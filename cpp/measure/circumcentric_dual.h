#pragma once

#include "base/cells.h"
#include "base/parallel.h"
#include "base/vec3.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace wct::measure {

using TetEdges = std::array<std::int32_t, 6>;

/// Signed heights of the circumcenters over the four facets of each tet, and bounds of their rounding errors, infinite
/// where the volume is in doubt: 4 m of each, in the unit of the points.
void heights(const std::vector<Vec3> &points, const std::vector<Tet> &tets, std::span<double> values,
             std::span<double> errors, const Workers &workers);

/// Per edge the sum of cot(gamma) h over the facets at it, gamma being the facet's angle opposite the edge and h the
/// circumcenter's height over the facet: four times the dual area over the edge's length. With bounds of their rounding
/// errors. `tet_edges` are numbers of edges, as kEdges; the heights and their errors, 4 m each, come out as well.
/// `coefficient`, m or none, multiplies each tet's part.
void edge_sums(const std::vector<Vec3> &points, const std::vector<Tet> &tets, const std::vector<TetEdges> &tet_edges,
               std::span<const double> coefficient, std::span<double> values, std::span<double> errors,
               std::span<double> sums, std::span<double> doubts, const Workers &workers);

/// Per tet the volume of the parts of dual cells in it, without their signs; infinite where it is not known.
void unsigned_volumes(const std::vector<Vec3> &points, const std::vector<Tet> &tets, std::span<double> out,
                      const Workers &workers);

/// Cosines of the angles between the normal of a facet and the line between the centroids of its two tets. A row of
/// `pairs`: a tet, its facet, the tet across, its facet.
void orthogonality(const std::vector<Vec3> &points, const std::vector<Tet> &tets,
                   const std::vector<std::array<std::int32_t, 4>> &pairs, std::span<double> out,
                   const Workers &workers);

} // namespace wct::measure
