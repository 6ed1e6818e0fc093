#pragma once

#include "base/cells.h"
#include "base/parallel.h"
#include "base/vec3.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// What a mesh is like, tet by tet. Nothing here is shared with what makes meshes better but the exact predicates: the
/// formulas are those of wct_plugin/measure/quality.py, which measures the same in NumPy and is what this is tested
/// against. Their derivation, and that of the bounds of rounding, stands in shape_polynomials.py beside it.
namespace wct::measure {

/// Where the measures of m tets go, an entry each. Angles in degrees; flags are exact.
struct QualityRows {
    std::span<double> min_height, max_height;                 // of the four h/R
    std::span<double> min_face_angle, max_face_angle;         // of the twelve
    std::span<double> min_dihedral_angle, max_dihedral_angle; // of the six
    std::span<double> radius_over_edge;                       // circumradius over shortest edge
    std::span<double> volume;                                 // signed
    std::span<std::int8_t> worst_facet;                       // the one with the smallest h/R
    std::span<bool> well_centered_3, well_centered_2, acute;
};

/// All of them in one pass. Corners of tets are positive ones; points are finite.
void measure(const std::vector<Vec3> &points, const std::vector<Tet> &tets, const QualityRows &out,
             const Workers &workers);

/// Signed volumes.
void volumes(const std::vector<Vec3> &points, const std::vector<Tet> &tets, std::span<double> out,
             const Workers &workers);

/// Circumradii; infinite or no number where a tet is flat.
void circumradii(const std::vector<Vec3> &points, const std::vector<Tet> &tets, std::span<double> out,
                 const Workers &workers);

/// How many of all dihedral angles, in degrees, are in each bin; `bins` ascend, the last one's end is in it.
std::vector<std::int64_t> dihedral_counts(const std::vector<Vec3> &points, const std::vector<Tet> &tets,
                                          std::span<const double> bins, const Workers &workers);

} // namespace wct::measure
