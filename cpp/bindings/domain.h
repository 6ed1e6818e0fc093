#pragma once

#include "bindings/attributes.h"

#include "domain/reference.h"
#include "domain/region_map.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace wct::bindings {

/// Meshes and surfaces, from and to the objects of wct_plugin.core.domain.

/// Tets in the strata of a surface, as a StratifiedMesh has them.
struct StratifiedMesh {
    std::vector<Vec3> points;
    std::vector<Tet> tets;
    std::vector<int> region;
    std::vector<Stratum> stratum;
    std::vector<std::int64_t> label;
    std::vector<double> size;
    std::vector<Facet> facets;
    std::vector<int> facet_patch;
    std::vector<Edge> creases;
    std::vector<int> crease_curve;
};

/// The fields of a StratifiedMesh; its patches and curves are checked against numbers that may be.
StratifiedMesh stratified_mesh_of(nanobind::handle mesh, std::int64_t patches, std::int64_t curves);

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
