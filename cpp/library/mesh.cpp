#include "library/mesh.h"

#include "base/cells.h"
#include "base/sort_unique.h"
#include "geometry/box_tree.h"
#include "geometry/predicates.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace wct::library {

namespace {

/// Diagonals of bounding boxes between which floating-point numbers hold volumes, also of small tets, and inverses.
constexpr double kSmallest = 1e-90, kLargest = 1e90;

std::string text(const char *what, std::size_t row) {
    return what + std::string(" ") + std::to_string(row);
}

void expect_indices(const WellCenterInput &input) {
    if (input.tets.empty())
        throw std::invalid_argument("the mesh has no tets");
    if (!input.regions.empty() && input.regions.size() != input.tets.size())
        throw std::invalid_argument("regions has length " + std::to_string(input.regions.size()) + "; there are " +
                                    std::to_string(input.tets.size()) + " tets");
    for (std::size_t t = 0; t < input.tets.size(); ++t) {
        const auto &tet = input.tets[t];
        for (int i = 0; i < 4; ++i) {
            if (tet[i] < 0 || static_cast<std::size_t>(tet[i]) >= input.points.size())
                throw std::invalid_argument(text("tet", t) + " names point " + std::to_string(tet[i]) + "; there are " +
                                            std::to_string(input.points.size()));
            for (int k = 0; k < i; ++k)
                if (tet[i] == tet[k])
                    throw std::invalid_argument(text("tet", t) + " has point " + std::to_string(tet[i]) + " twice");
        }
    }
}

/// The points that tets have, in the input's unit, and tets and facets on them.
void take_points(const WellCenterInput &input, Mesh &mesh) {
    std::vector<int> place(input.points.size(), -1);
    for (const auto &tet : input.tets)
        for (const int v : tet)
            place[v] = 0;
    for (std::size_t v = 0; v < input.points.size(); ++v) {
        if (place[v] < 0)
            continue;
        const auto &[x, y, z] = input.points[v];
        if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z))
            throw std::invalid_argument(text("point", v) + " is not finite");
        place[v] = static_cast<int>(mesh.origin.size());
        mesh.cells.points.push_back({x, y, z});
        mesh.origin.push_back(static_cast<int>(v));
    }
    for (const auto &[a, b, c, d] : input.tets)
        mesh.cells.tets.push_back({place[a], place[b], place[c], place[d]});
    for (auto &[a, b, c] : mesh.surface.triangles)
        a = place[a], b = place[b], c = place[c];
}

void choose_unit(Mesh &mesh) {
    geometry::Box box;
    for (const Vec3 &p : mesh.cells.points)
        box.add(p);
    const double diagonal = box.diagonal();
    if (!(diagonal >= kSmallest && diagonal <= kLargest))
        throw std::invalid_argument(
            "the bounding box's diagonal is not between 1e-90 and 1e90: choose another unit of length");
    int exponent = 0;
    std::frexp(diagonal / 1.5, &exponent);
    mesh.unit = exponent - 1;
    for (Vec3 &p : mesh.cells.points)
        p = {std::ldexp(p.x, -mesh.unit), std::ldexp(p.y, -mesh.unit), std::ldexp(p.z, -mesh.unit)};
    mesh.diagonal = std::ldexp(diagonal, -mesh.unit);
}

void number_regions(const WellCenterInput &input, Mesh &mesh) {
    if (input.regions.empty()) {
        mesh.regions = {0};
        mesh.cells.region.assign(input.tets.size(), 0);
        return;
    }
    mesh.regions.assign(input.regions.begin(), input.regions.end());
    sort_unique(mesh.regions);
    for (const int tag : input.regions)
        mesh.cells.region.push_back(
            static_cast<int>(std::lower_bound(mesh.regions.begin(), mesh.regions.end(), tag) - mesh.regions.begin()));
}

} // namespace

Mesh checked(const WellCenterInput &input) {
    expect_indices(input);
    Mesh mesh;
    number_regions(input, mesh);
    mesh.surface = surface_of(input.tets, mesh.cells.region); // while points have the user's numbers
    take_points(input, mesh);
    choose_unit(mesh);
    const auto &at = mesh.cells.points;
    for (std::size_t t = 0; t < mesh.cells.tets.size(); ++t) {
        const auto &[a, b, c, d] = mesh.cells.tets[t];
        if (geometry::orient3d(at[a], at[b], at[c], at[d]) <= 0)
            throw std::invalid_argument(text("tet", t) + " is inverted or flat");
    }
    return mesh;
}

std::size_t count_bad(const std::vector<Vec3> &points, const std::vector<std::array<int, 4>> &tets,
                      WellCenterGoal goal) {
    const bool all_acute = goal == WellCenterGoal::completely_well_centered;
    std::size_t bad = 0;
    for (const auto &[a, b, c, d] : tets) {
        const std::array<Vec3, 4> at{points[a], points[b], points[c], points[d]};
        const auto acute = [&](const int (&facet)[3]) {
            return geometry::acute(at[facet[0]], at[facet[1]], at[facet[2]]);
        };
        bad += !geometry::contains_circumcenter(at[0], at[1], at[2], at[3]) ||
               (all_acute && !std::all_of(std::begin(kFacets), std::end(kFacets), acute));
    }
    return bad;
}

std::vector<double> volumes_of(const std::vector<Vec3> &points, const std::vector<std::array<int, 4>> &tets,
                               const std::vector<int> &region, std::size_t regions) {
    std::vector<double> volume(regions, 0.0);
    for (std::size_t t = 0; t < tets.size(); ++t) {
        const auto &[a, b, c, d] = tets[t];
        const Vec3 &at = points[a];
        volume[region[t]] += dot(points[b] - at, cross(points[c] - at, points[d] - at)) / 6.0;
    }
    return volume;
}

} // namespace wct::library
