#include "library/strata.h"

#include "library/crease_noise.h"
#include "library/edge_chains.h"

#include <numbers>

namespace wct::library {

Strata find_strata(std::span<const Vec3> points, const SurfaceFacets &surface, double crease_angle) {
    const std::size_t triangles = surface.triangles.size();
    const geometry::TriangleEdges edges(surface.triangles);
    const std::vector<double> bend = geometry::bend_angles(points, surface.triangles, edges);
    const double sharp = crease_angle / 180.0 * std::numbers::pi;
    CreaseEdges creases;
    for (std::size_t e = 0; e < edges.count(); ++e) {
        const bool hard = !edges.paired(e) || surface.sides[edges.first(e)] != surface.sides[edges.last(e)];
        creases.hard.push_back(hard);
        creases.crease.push_back(hard || bend[e] > sharp);
    }
    std::vector<std::uint8_t> corner;
    for (const int sheets : geometry::sheets_at(surface.triangles, edges, points.size()))
        corner.push_back(sheets > 1);
    drop_noise(points, triangles, edges, corner, creases);

    Strata out;
    for (std::size_t e = 0; e < edges.count(); ++e)
        if (creases.crease[e]) {
            out.segments.push_back(edges.edges()[e]);
            out.soft.push_back(!creases.hard[e]);
        }
    const std::vector<std::uint8_t> ends = ends_and_turns(points, out.segments);
    for (std::size_t v = 0; v < points.size(); ++v)
        corner[v] |= ends[v];
    out.curve = chains_of(out.segments, corner);
    out.patch = patches_between(edges, creases.crease, triangles);
    out.stratum.assign(points.size(), Stratum::interior);
    out.label.assign(points.size(), -1);
    const auto put = [&](const auto &cell, Stratum stratum, int label) {
        for (const int v : cell) {
            out.stratum[v] = stratum;
            out.label[v] = label;
        }
    };
    for (std::size_t t = 0; t < triangles; ++t)
        put(surface.triangles[t], Stratum::patch, out.patch[t]);
    for (std::size_t s = 0; s < out.segments.size(); ++s)
        put(out.segments[s], Stratum::crease, out.curve[s]);
    for (std::size_t v = 0; v < points.size(); ++v)
        if (corner[v])
            put(std::array{static_cast<int>(v)}, Stratum::corner, -1);
    return out;
}

} // namespace wct::library
