#pragma once

#include "base/cells.h"
#include "base/vec3.h"
#include "library/surface_facets.h"

#include <cstdint>
#include <span>
#include <vector>

namespace wct::library {

/// What a vertex may do: move freely, on its patch, along its curve, or not at all. The same rules as those of
/// wct_plugin/mesh/strata.py, without tags.
struct Strata {
    std::vector<int> patch;         // per triangle, from 0
    std::vector<Edge> segments;     // creases, ends ascending, in lexicographic order
    std::vector<int> curve;         // per segment, from 0
    std::vector<std::uint8_t> soft; // per segment: its angle alone makes it a crease
    std::vector<Stratum> stratum;   // per point
    std::vector<int> label;         // per point: patch or curve, -1 inside and at corners
};

/// A crease is an edge where the surface bends by more than the angle (degrees), where other than two triangles meet,
/// or where the regions on either side change. Short dangling creases, and rims of one to four triangles inside a
/// patch, that only their angle makes are dropped. A corner is a vertex where other than two creases meet or one turns
/// by more than 45 degrees, or where sheets of the surface touch that share no edge.
Strata find_strata(std::span<const Vec3> points, const SurfaceFacets &surface, double crease_angle);

} // namespace wct::library
