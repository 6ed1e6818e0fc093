#pragma once

#include "cells.h"
#include "restricted.h"

#include <vector>

namespace wct {

/// Which patch each surface facet of a complex covers, and which curve each crease edge follows.
struct SurfaceLabels {
    std::vector<Facet> facets; // outward, or out of the region with the smaller number
    std::vector<int> patch;
    std::vector<Edge> creases; // edges between facets of different patches or along a slit in one, ends ascending
    std::vector<int> curve;
};

SurfaceLabels label_surface(const Cloud &cloud, const Complex &complex, const Reference &reference);

} // namespace wct
