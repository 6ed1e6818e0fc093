#pragma once

#include "domain/reference.h"
#include "sampling/cloud.h"
#include "sampling/restricted_delaunay.h"

#include <vector>

namespace wct::sampling {

/// How far the mesh's surface lies from the reference.
struct Deviation {
    // Per reference vertex, from the facet nearest to it and its neighbours (means over the facets around a point, so
    // that one odd facet does not count for a bend):
    std::vector<double> above;  // greatest signed distance of the mesh from the reference
    std::vector<double> below;  // the smallest
    std::vector<double> missed; // greatest distance from the reference to the mesh
    // Whole:
    double most_out = 0.0;    // mesh to reference
    double most_in = 0.0;     // reference to mesh
    double volume_gain = 0.0; // volume of the mesh over the volume inside the reference, minus 1
};

/// Facet samples both ways; distances to the nearest point of the other surface.
Deviation measure_deviation(const Cloud &cloud, const RestrictedDelaunay &complex, const domain::Reference &reference,
                            const Workers &workers);

} // namespace wct::sampling
