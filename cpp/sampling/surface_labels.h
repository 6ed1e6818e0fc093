#pragma once

#include "base/cells.h"
#include "sampling/restricted_delaunay.h"

#include <vector>

namespace wct::sampling {

/// Which patch each surface facet of a complex covers, and which curve each crease edge follows.
struct SurfaceLabels {
    std::vector<Facet> facets; // outward, or out of the region with the smaller number
    std::vector<int> patch;
    std::vector<Edge> creases; // edges between facets of different patches or along a slit in one, ends ascending
    std::vector<int> curve;
};

/// Points of the reference's patches that no facet of the complex has, as where a fold of the reference is closed, lie
/// inside and become interior. Creases and corners that are inside in the reference too stay what they are.
void free_buried(Cloud &cloud, const RestrictedDelaunay &complex, const domain::Reference &reference);

SurfaceLabels label_surface(const Cloud &cloud, const RestrictedDelaunay &complex, const domain::Reference &reference,
                            const HeldSurface *held = nullptr);

} // namespace wct::sampling
