#pragma once

#include "base/cells.h"
#include "domain/reference.h"
#include "sampling/cloud.h"
#include "sampling/restricted_delaunay.h"

#include <array>
#include <vector>

namespace wct::sampling {

/// A point of a surface facet and the plane of the reference it was found nearest to: near there, the distance between
/// the two surfaces is |dot(normal, sum of weight * corner) - level|.
struct Tie {
    Facet corner;
    std::array<double, 3> weight;
    Vec3 normal;
    double level = 0.0;
};

/// How facets over curved patches are held near the reference.
struct FitForm {
    double limit = 0.0;  // distance that costs nothing
    double weight = 0.1; // of (distance / limit - 1)^2 in the descent
    double pull = 0.02;  // of points towards their offset, relative to that
    double shell = 0.0;  // greatest distance of a point
};

/// Ties of all facets over curved patches, both ways: samples of each facet to the reference, and each vertex of the
/// reference to the facet nearest to it, so that no peak sticks out between chords.
std::vector<Tie> tie_surface(const Cloud &cloud, const RestrictedDelaunay &complex, const domain::Reference &reference,
                             const Workers &workers);

/// Raise and lower the points of curved patches along their normals (`direction`) to where the ties are within the
/// limit as far as possible, near their offsets otherwise.
void fit_heights(Cloud &cloud, const domain::Reference &reference, const std::vector<Tie> &ties,
                 const std::vector<Vec3> &direction, const FitForm &form, const Workers &workers);

/// How many facets have a tie longer than the limit.
std::size_t count_off(const Cloud &cloud, const std::vector<Tie> &ties, double limit);

} // namespace wct::sampling
