#pragma once

#include "base/vec3.h"
#include "domain/region_map.h"
#include "library/surface_facets.h"
#include "library/well_center.h"

#include <vector>

namespace wct::library {

/// The mesh that came in, in a unit of length of its own: a power of two, so that no digit changes, in which the
/// bounding box's diagonal is from 1.5 to 3. On the way up to eight lengths are multiplied, which neither 1e-60 nor
/// 1e60 survives.
struct Mesh {
    domain::InputMesh cells;  // points that tets have, and no others; regions by index
    SurfaceFacets surface;    // of the cells
    std::vector<int> origin;  // per point its row in what came in
    std::vector<int> regions; // the user's numbers, ascending: by index
    int unit = 0;             // exponent of the power of two
    double diagonal = 0.0;    // of the bounding box, in that unit
};

/// std::invalid_argument says what of the input is not as WellCenterInput says.
Mesh checked(const WellCenterInput &input);

/// How many of the tets miss the goal, exactly.
std::size_t count_bad(const std::vector<Vec3> &points, const std::vector<std::array<int, 4>> &tets,
                      WellCenterGoal goal);

/// Per region the volume of its tets.
std::vector<double> volumes_of(const std::vector<Vec3> &points, const std::vector<std::array<int, 4>> &tets,
                               const std::vector<int> &region, std::size_t regions);

} // namespace wct::library
