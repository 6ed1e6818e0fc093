#pragma once

#include "bindings/arrays.h"

#include "domain/reference.h"
#include "domain/region_map.h"

#include <optional>

namespace wct::bindings {

/// What a mesh is made for, from NumPy arrays: the mesh that came in and the surface to stay near.

inline domain::InputMesh mesh_of(const Array &points, const Array &tets, const Array &region) {
    domain::InputMesh mesh;
    mesh.points = points_of(points);
    mesh.tets = cells_of<4>(tets, mesh.points.size(), "tets");
    mesh.region = numbers_of(region, mesh.tets.size(), std::int64_t{1} << 30, "region");
    return mesh;
}

/// Edge lengths wanted at the mesh's points; empty where none are given.
inline std::vector<double> wanted_of(const std::optional<Array> &size, const domain::InputMesh &mesh) {
    return size ? sizes_of(*size, mesh.points.size(), "size") : std::vector<double>{};
}

/// A surface without creases and corners.
inline domain::SurfaceData surface_of(std::vector<Vec3> points, const Array &triangles, const char *triangles_name,
                                      const Array &patch, const char *patch_name, const Array &sides) {
    domain::SurfaceData surface;
    surface.points = std::move(points);
    surface.triangles = cells_of<3>(triangles, surface.points.size(), triangles_name);
    const auto of_sides = rows<std::int64_t>(sides, 2, "sides");
    for (std::size_t i = 0; i < of_sides.size(); i += 2)
        surface.sides.push_back({static_cast<int>(of_sides[i]), static_cast<int>(of_sides[i + 1])});
    surface.patch =
        numbers_of(patch, surface.triangles.size(), static_cast<std::int64_t>(surface.sides.size()), patch_name);
    return surface;
}

/// A surface that is one patch.
inline domain::SurfaceData plain_surface(const Array &points, const char *points_name, const Array &triangles,
                                         const char *triangles_name) {
    domain::SurfaceData surface;
    surface.points = points_of(points, points_name);
    surface.triangles = cells_of<3>(triangles, surface.points.size(), triangles_name);
    surface.patch.assign(surface.triangles.size(), 0);
    surface.sides = {{0, -1}};
    return surface;
}

} // namespace wct::bindings
