#pragma once

#include "bindings/attributes.h"

#include "domain/reference.h"
#include "domain/region_map.h"
#include "search/search_mesh.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace wct::bindings {

/// Meshes and surfaces, from and to the objects of wct_plugin.core.domain.

/// A StratifiedMesh; there are so many numbers for its patches and curves.
search::SearchMesh search_mesh_of(nanobind::handle mesh, std::int64_t patches, std::int64_t curves);

/// The same the other way.
nanobind::object stratified_mesh_of(const search::SearchMesh &mesh);

/// The points, tets and regions of a RegionMesh, or of a StratifiedMesh.
domain::InputMesh region_mesh_of(nanobind::handle mesh);

/// A StratifiedSurface.
domain::SurfaceData surface_of(nanobind::handle surface);

/// The facets of a StratifiedMesh as a surface with these sides, without creases and corners.
domain::SurfaceData surface_of_facets(nanobind::handle mesh, const std::vector<Vec3> &points, const Array &sides);

/// Points and triangles as a surface that is one patch.
domain::SurfaceData plain_surface_of(nanobind::handle triangles);

/// Edge lengths wanted at the mesh's points; empty where none are given.
std::vector<double> wanted_of(const std::optional<Array> &size, const domain::InputMesh &mesh);

} // namespace wct::bindings
