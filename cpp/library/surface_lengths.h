#pragma once

#include "library/own_surface.h"

#include <vector>

namespace wct::library {

/// How far facets of a smooth surface lie from it, a length: the 99 % quantile over the facets.
///
/// The smooth surface is the one with the vertex normals of each patch, weighted by angle (Thuermer and Wuethrich,
/// "Computing vertex normals from polygonal facets", 1998). Along an edge e from corner i to j the normal turns by
/// d = (n_j - n_i) . e; a surface whose normals turn so lies an eighth of d above the middle of the edge, and an
/// eighteenth of their sum above the middle of the facet. Only what bends along an edge counts: on the long strips of a
/// cylinder that is their width.
double facet_sag(const OwnSurface &surface);

/// Per point of the surface the longest edge it may have: 1.25 times the mean edge of its patch there, smoothed, and
/// 0.82 of that on interfaces; of several patches the least. At points inside the longest of all.
std::vector<double> longest_edges(const OwnSurface &surface);

} // namespace wct::library
