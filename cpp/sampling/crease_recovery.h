#pragma once

#include "domain/reference.h"
#include "sampling/cloud.h"
#include "sampling/restricted_delaunay.h"

#include <vector>

namespace wct::sampling {

/// Two points of the cloud that follow one another on a curve of the reference and are not joined on the surface.
struct CreaseGap {
    int curve;
    int first, second;
    double at; // half-way between them along the curve, in steps of its chain
};

/// Where the complex lacks creases.
std::vector<CreaseGap> crease_gaps(const Cloud &cloud, const domain::Reference &reference,
                                   const RestrictedDelaunay &complex);

/// Creases must be edges of the mesh: a patch point that stands in a gap becomes a point of the crease, and where none
/// does a new point is put half-way. Returns the number of points that the creases got.
int recover_creases(Cloud &cloud, const domain::Reference &reference, const RestrictedDelaunay &complex,
                    const HeldSurface *held, const Workers &workers);

} // namespace wct::sampling
