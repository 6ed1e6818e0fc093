#pragma once

#include "domain/reference.h"
#include "library/mesh.h"
#include "library/strata.h"

#include <array>
#include <cstdint>
#include <vector>

namespace wct::library {

/// A mesh's own boundary and interfaces, which a new mesh stays near.
struct OwnSurface {
    std::vector<Vec3> points; // of the mesh
    std::vector<Facet> triangles;
    Strata strata;
    std::vector<std::array<int, 2>> sides; // per patch: the region behind its triangles and before, -1: outside
    double diagonal = 0.0;
};

OwnSurface own_surface(const Mesh &mesh, double crease_angle);

/// The same in the form that sampling works with.
domain::SurfaceData surface_data(const OwnSurface &surface);

/// How many numbers curves have.
std::size_t curve_count(const Strata &strata);

/// Per curve whether its angle alone makes it a crease, all along.
std::vector<std::uint8_t> soft_curves(const Strata &strata);

/// The surface with these curves, creases by their angle, given up: patches on either side of one are joined under the
/// smallest of their numbers, all other numbers stay. What vertices of the old mesh may do stays as it was.
OwnSurface without(const OwnSurface &surface, const std::vector<int> &curves);

/// Per region the volume between the surface's sides.
std::vector<double> enclosed_volumes(const OwnSurface &surface, std::size_t regions);

} // namespace wct::library
