#pragma once

#include "base/vec3.h"
#include "delaunay/delaunay.h"

#include <span>
#include <vector>

namespace wct::delaunay {

/// Points on one sphere leave a choice, and rounding may take a flat tet for a part of it, as between two ways to cut a
/// rectangle. Take such tets out, those with a dihedral angle below `sharpest`, in radians: one of their edges goes,
/// and what was round it is filled with tets that are not as flat. The spheres of all tets stay empty but for rounding.
/// Only tets of one label are changed, the labels (one per tet, below 0: left alone) following.
void remove_flat(Triangulation &all, std::vector<int> &label, std::span<const Vec3> points, double sharpest);

} // namespace wct::delaunay
