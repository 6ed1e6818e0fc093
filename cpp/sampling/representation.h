#pragma once

#include "domain/reference.h"
#include "domain/region_map.h"
#include "sampling/cloud.h"
#include "sampling/held_surface.h"
#include "sampling/restricted_delaunay.h"

#include <vector>

namespace wct::sampling {

/// The complex of the settled points, changed until the domain's creases and surfaces are in it. `touched` receives the
/// points where sheets touched on the way. `moving`: as of labelled_delaunay.
Flaws represent(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map, const HeldSurface *held,
                double shell, std::vector<Vec3> &direction, RestrictedDelaunay &complex, std::vector<int> &touched,
                const Workers &workers, delaunay::MovingDelaunay *moving = nullptr);

} // namespace wct::sampling
