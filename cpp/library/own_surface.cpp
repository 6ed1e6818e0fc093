#include "library/own_surface.h"

#include "geometry/triangle_edges.h"

#include <algorithm>

namespace wct::library {

OwnSurface own_surface(const Mesh &mesh, double crease_angle) {
    OwnSurface own;
    own.points = mesh.cells.points;
    own.triangles = mesh.surface.triangles;
    own.strata = find_strata(own.points, mesh.surface, crease_angle);
    own.diagonal = mesh.diagonal;
    const std::vector<int> &patch = own.strata.patch;
    own.sides.resize(static_cast<std::size_t>(*std::max_element(patch.begin(), patch.end())) + 1);
    for (std::size_t t = 0; t < patch.size(); ++t)
        own.sides[patch[t]] = mesh.surface.sides[t];
    return own;
}

domain::SurfaceData surface_data(const OwnSurface &surface) {
    domain::SurfaceData data;
    data.points = surface.points;
    data.triangles = surface.triangles;
    data.patch = surface.strata.patch;
    data.segments = surface.strata.segments;
    data.curve = surface.strata.curve;
    data.sides = surface.sides;
    for (std::size_t v = 0; v < surface.points.size(); ++v)
        if (surface.strata.stratum[v] == Stratum::corner)
            data.corners.push_back(static_cast<int>(v));
    return data;
}

std::size_t curve_count(const Strata &strata) {
    const auto last = std::max_element(strata.curve.begin(), strata.curve.end());
    return last == strata.curve.end() ? 0 : static_cast<std::size_t>(*last) + 1;
}

std::vector<std::uint8_t> soft_curves(const Strata &strata) {
    std::vector<std::uint8_t> soft(curve_count(strata), 1);
    for (std::size_t s = 0; s < strata.curve.size(); ++s)
        soft[strata.curve[s]] &= strata.soft[s];
    return soft;
}

OwnSurface without(const OwnSurface &surface, const std::vector<int> &curves) {
    if (curves.empty())
        return surface;
    OwnSurface out = surface;
    Strata &strata = out.strata;
    std::vector<Edge> gone;
    std::size_t kept = 0;
    for (std::size_t s = 0; s < strata.segments.size(); ++s) {
        if (std::binary_search(curves.begin(), curves.end(), strata.curve[s])) {
            gone.push_back(strata.segments[s]);
            continue;
        }
        strata.segments[kept] = strata.segments[s];
        strata.curve[kept] = strata.curve[s];
        strata.soft[kept++] = strata.soft[s];
    }
    strata.segments.resize(kept);
    strata.curve.resize(kept);
    strata.soft.resize(kept);
    std::sort(gone.begin(), gone.end());
    const std::vector<int> becomes =
        geometry::joined_patches(strata.patch, geometry::TriangleEdges(out.triangles), gone);
    for (int &p : strata.patch)
        p = becomes[p];
    return out;
}

std::vector<double> enclosed_volumes(const OwnSurface &surface, std::size_t regions) {
    Vec3 middle;
    for (const Facet &triangle : surface.triangles)
        for (const int v : triangle)
            middle += surface.points[v];
    middle = (1.0 / (3.0 * static_cast<double>(surface.triangles.size()))) * middle; // near it nothing cancels
    std::vector<double> volume(regions, 0.0);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto &[a, b, c] = surface.triangles[t];
        const auto &at = surface.points;
        const double cone = six_volumes(middle, at[a], at[b], at[c]) / 6.0;
        const auto &[behind, before] = surface.sides[surface.strata.patch[t]];
        if (behind >= 0)
            volume[behind] += cone;
        if (before >= 0)
            volume[before] -= cone;
    }
    return volume;
}

} // namespace wct::library
