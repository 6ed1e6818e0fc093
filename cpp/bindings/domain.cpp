#include "bindings/domain.h"

#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace nb = nanobind;

namespace wct::bindings {

search::StratifiedMesh stratified_mesh_of(nb::handle mesh, std::size_t patches, std::size_t curves) {
    search::StratifiedMesh out;
    domain::InputMesh inside = region_mesh_of(mesh);
    out.points = std::move(inside.points);
    out.tets = std::move(inside.tets);
    out.region = std::move(inside.region);
    const std::size_t count = out.points.size();
    out.stratum = strata_of(attribute<Array>(mesh, "stratum"), count);
    const auto label = labels_of(attribute<Array>(mesh, "label"), count, "label");
    for (std::size_t v = 0; v < count; ++v)
        if (label[v] < std::numeric_limits<int>::min() || label[v] > std::numeric_limits<int>::max())
            refuse("label of point " + std::to_string(v) + " is " + std::to_string(label[v]));
    out.label.assign(label.begin(), label.end());
    out.size = sizes_of(attribute<Array>(mesh, "size"), count, "size");
    out.facets = cells_of<3>(attribute<Array>(mesh, "facets"), count, "facets");
    out.facet_patch = numbers_of(attribute<Array>(mesh, "facet_patch"), out.facets.size(),
                                 static_cast<std::int64_t>(patches), "facet_patch");
    out.creases = cells_of<2>(attribute<Array>(mesh, "creases"), count, "creases");
    out.crease_curve = numbers_of(attribute<Array>(mesh, "crease_curve"), out.creases.size(),
                                  static_cast<std::int64_t>(curves), "crease_curve");
    return out;
}

nb::object object_of(const search::StratifiedMesh &mesh) {
    nb::dict out;
    out["points"] = array_of(mesh.points);
    out["tets"] = array_of<std::int64_t>(mesh.tets);
    out["regions"] = array_of<std::int64_t>(mesh.region);
    out["stratum"] = array_of(mesh.stratum);
    out["label"] = array_of<std::int64_t>(mesh.label);
    out["size"] = array_of<double>(mesh.size);
    out["facets"] = array_of<std::int64_t>(mesh.facets);
    out["facet_patch"] = array_of<std::int64_t>(mesh.facet_patch);
    out["creases"] = array_of<std::int64_t>(mesh.creases);
    out["crease_curve"] = array_of<std::int64_t>(mesh.crease_curve);
    return made("wct_plugin.core.domain", "StratifiedMesh", out);
}

domain::InputMesh region_mesh_of(nb::handle mesh) {
    domain::InputMesh out;
    out.points = points_of(attribute<Array>(mesh, "points"));
    out.tets = cells_of<4>(attribute<Array>(mesh, "tets"), out.points.size(), "tets");
    out.region =
        numbers_of(attribute<Array>(mesh, "regions"), out.tets.size(), std::numeric_limits<int>::max(), "regions");
    return out;
}

std::vector<std::array<int, 2>> sides_of(const Array &sides) {
    const auto values = rows<std::int64_t>(sides, 2, "sides");
    std::vector<std::array<int, 2>> out;
    for (std::size_t i = 0; i < values.size(); i += 2)
        out.push_back({static_cast<int>(values[i]), static_cast<int>(values[i + 1])});
    return out;
}

search::StratifiedMesh mesh_with_surface(nb::handle mesh, const std::vector<std::array<int, 2>> &sides) {
    search::StratifiedMesh out = stratified_mesh_of(mesh, sides.size(), attribute<Array>(mesh, "crease_curve").size());
    if (out.facets.empty() || out.tets.empty())
        throw std::invalid_argument("facets and tets are needed");
    return out;
}

domain::SurfaceData surface_of(nb::handle surface) {
    domain::SurfaceData out;
    out.points = points_of(attribute<Array>(surface, "points"), "points of the surface");
    const std::size_t count = out.points.size();
    out.triangles = cells_of<3>(attribute<Array>(surface, "triangles"), count, "triangles");
    out.sides = sides_of(attribute<Array>(surface, "sides"));
    const std::size_t patches = out.sides.empty() ? out.triangles.size() : out.sides.size();
    out.patch = numbers_of(attribute<Array>(surface, "patch"), out.triangles.size(), static_cast<std::int64_t>(patches),
                           "patch");
    out.segments = cells_of<2>(attribute<Array>(surface, "segments"), count, "segments");
    out.curve = curves_of(attribute<Array>(surface, "curve"), out.segments.size(), out.triangles.size(), "curve");
    out.corners = numbers_of(attribute<Array>(surface, "corners"), static_cast<std::int64_t>(count), "corners");
    out.folds = cells_of<2>(attribute<Array>(surface, "folds"), count, "folds");
    out.flat = attribute<double>(surface, "flat");
    if (!(out.flat >= 0.0))
        refuse("flat is " + std::to_string(out.flat) + "; it may not be negative");
    return out;
}

domain::SurfaceData surface_of_facets(const search::StratifiedMesh &mesh, std::vector<std::array<int, 2>> sides) {
    domain::SurfaceData out;
    out.points = mesh.points;
    out.triangles = mesh.facets;
    out.patch = mesh.facet_patch;
    out.sides = std::move(sides);
    return out;
}

domain::SurfaceData plain_surface_of(nb::handle triangles) {
    domain::SurfaceData out;
    out.points = points_of(attribute<Array>(triangles, "points"), "points of the triangles");
    out.triangles = cells_of<3>(attribute<Array>(triangles, "triangles"), out.points.size(), "triangles");
    out.patch.assign(out.triangles.size(), 0);
    out.sides = {{0, -1}};
    return out;
}

std::vector<double> wanted_of(const std::optional<Array> &size, const domain::InputMesh &mesh) {
    return size ? sizes_of(*size, mesh.points.size(), "size") : std::vector<double>{};
}

} // namespace wct::bindings
