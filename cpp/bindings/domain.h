#pragma once

#include "bindings/attributes.h"

#include "domain/reference.h"
#include "domain/region_map.h"
#include "search/stratified_mesh.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace wct::bindings {

/// Meshes and surfaces, from and to the objects of wct_plugin.core.domain.

/// A StratifiedMesh; there are so many numbers for its patches and curves.
search::StratifiedMesh stratified_mesh_of(nanobind::handle mesh, std::size_t patches, std::size_t curves);

/// The same the other way.
nanobind::object object_of(const search::StratifiedMesh &mesh);

/// The region behind each patch and the one before: an (n, 2) array.
std::vector<std::array<int, 2>> sides_of(const Array &sides);

/// A StratifiedMesh whose own facets, with these sides, are the surface: its patches and curves are numbered without a
/// surface beside. ValueError where it has no facets or no tets.
search::StratifiedMesh mesh_with_surface(nanobind::handle mesh, const std::vector<std::array<int, 2>> &sides);

/// The points, tets and regions of a RegionMesh, or of a StratifiedMesh.
domain::InputMesh region_mesh_of(nanobind::handle mesh);

/// A StratifiedSurface.
domain::SurfaceData surface_of(nanobind::handle surface);

/// The facets of a mesh as a surface with these sides, without creases and corners.
domain::SurfaceData surface_of_facets(const search::StratifiedMesh &mesh, std::vector<std::array<int, 2>> sides);

/// Points and triangles as a surface that is one patch.
domain::SurfaceData plain_surface_of(nanobind::handle triangles);

/// Edge lengths wanted at the mesh's points; empty where none are given.
std::vector<double> wanted_of(const std::optional<Array> &size, const domain::InputMesh &mesh);

} // namespace wct::bindings
