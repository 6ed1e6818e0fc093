#include "geometry/dihedral_angles.h"

#include "base/cells.h"

#include <algorithm>
#include <cmath>

namespace wct::geometry {

double smallest_dihedral(const std::array<Vec3, 4> &tet) {
    std::array<Vec3, 4> normals; // all inward: the angles between them are those of the outward ones
    for (int i = 0; i < 4; ++i) {
        const auto &[a, b, c] = kFacets[i];
        normals[i] = unit(cross(tet[b] - tet[a], tet[c] - tet[a]));
    }
    double sharpest = -1.0; // cosine
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < i; ++j)
            sharpest = std::max(sharpest, -dot(normals[i], normals[j]));
    return std::acos(std::min(sharpest, 1.0));
}

} // namespace wct::geometry
