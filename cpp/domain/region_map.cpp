#include "domain/region_map.h"

#include "base/facet_uses.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>
#include <map>

namespace wct::domain {

RegionMap::RegionMap(const InputMesh &mesh, const Reference &reference) : mesh_(mesh), reference_(reference) {
    std::vector<geometry::Box> boxes;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        geometry::Box box;
        for (const int v : mesh.tets[t])
            box.add(mesh.points[v]);
        boxes.push_back(box);
        const auto &[a, b, c, d] = mesh.tets[t];
        volume_.push_back(six_volumes(mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[d]));
    }
    tets_ = geometry::BoxTree(boxes);
    boxes.clear();
    FacetUses(mesh.tets, mesh.points.size()).each([&](const auto &, std::span<const FacetUses::Use> uses) {
        const int t = uses.front().tet(), i = uses.front().corner();
        if (uses.size() > 1 && mesh.region[t] == mesh.region[uses.back().tet()])
            return;
        const SurfaceFacet facet{outward_facet(mesh.tets[t], i), t, i};
        geometry::Box box;
        Vec3 center;
        double gap = 0.0;
        for (const int v : facet.corner) {
            box.add(mesh.points[v]);
            center += (1.0 / 3.0) * mesh.points[v];
            gap = std::max(gap, reference.nearest(mesh.points[v]).distance);
        }
        gap = std::max(gap, reference.nearest(center).distance);
        strip_.push_back(4.0 * gap * gap);
        facets_.push_back(facet);
        boxes.push_back(box);
    });
    surface_ = geometry::BoxTree(boxes);
    std::vector<double> values;
    std::transform(strip_.begin(), strip_.end(), std::back_inserter(values), std::negate());
    widest_ = surface_.smallest(values);
}

Place RegionMap::find(const Vec3 &p) const {
    Place place;
    tets_.visit([&](const geometry::Box &box) { return box.contains(p); },
                [&](std::size_t t) {
                    const auto &[a, b, c, d] = mesh_.tets[t];
                    const Vec3 &pa = mesh_.points[a];
                    const Vec3 &pb = mesh_.points[b];
                    const Vec3 &pc = mesh_.points[c];
                    const Vec3 &pd = mesh_.points[d];
                    constexpr double slack = 1e-12; // of the volume, so that no point falls between two tets
                    const double least = -slack * volume_[t];
                    double w[4];
                    if ((w[0] = six_volumes(p, pb, pc, pd)) < least || (w[1] = six_volumes(pa, p, pc, pd)) < least ||
                        (w[2] = six_volumes(pa, pb, p, pd)) < least || (w[3] = six_volumes(pa, pb, pc, p)) < least)
                        return false;
                    place.tet = static_cast<int>(t);
                    const double sum = w[0] + w[1] + w[2] + w[3];
                    for (int k = 0; k < 4; ++k)
                        place.weight[k] = w[k] / sum;
                    return true;
                });
    return place;
}

Place RegionMap::find_or_nearest(const Vec3 &p) const {
    Place place = find(p);
    if (place.tet >= 0)
        return place;
    surface_.minimise(
        std::numeric_limits<double>::infinity(), [&](std::size_t node) { return surface_.box(node).square(p); },
        [&](std::size_t item, double best) {
            const SurfaceFacet &f = facets_[item];
            const geometry::TrianglePoint at = geometry::nearest_on_triangle(
                p, mesh_.points[f.corner[0]], mesh_.points[f.corner[1]], mesh_.points[f.corner[2]]);
            if (at.square < best) {
                place = {f.tet, {0.0, 0.0, 0.0, 0.0}};
                for (int k = 0; k < 3; ++k)
                    place.weight[kOutward[f.opposite][k]] = at.weight[k];
            }
            return at.square;
        });
    return place;
}

int RegionMap::region(const Vec3 &p, int hint) const {
    // Beyond the strips of all facets the surface has no say.
    constexpr double none = std::numeric_limits<double>::min(), found = -std::numeric_limits<double>::infinity();
    const bool beside =
        surface_.minimise(
            none, [&](std::size_t node) { return surface_.box(node).square(p) + widest_[node]; },
            [&](std::size_t item, double best) {
                const auto &[a, b, c] = facets_[item].corner;
                const double square =
                    geometry::nearest_on_triangle(p, mesh_.points[a], mesh_.points[b], mesh_.points[c]).square;
                return square <= strip_[item] ? found : best;
            }) == found;
    if (beside)
        return region(p, reference_.nearest(p, -1, hint));
    const Place place = find(p);
    return place.tet >= 0 ? mesh_.region[place.tet] : -1;
}

int RegionMap::region(const Vec3 &p, const Foot &foot) const {
    const Place place = find(p);
    const int by_tets = place.tet >= 0 ? mesh_.region[place.tet] : -1;
    if (foot.triangle < 0)
        return by_tets;
    const int by_surface = reference_.region_beside(p, foot);
    if (by_tets == by_surface)
        return by_tets;
    double strip = 0.0;
    const double square = surface_.minimise(
        std::numeric_limits<double>::infinity(), [&](std::size_t node) { return surface_.box(node).square(p); },
        [&](std::size_t item, double best) {
            const SurfaceFacet &f = facets_[item];
            const double far = geometry::nearest_on_triangle(p, mesh_.points[f.corner[0]], mesh_.points[f.corner[1]],
                                                             mesh_.points[f.corner[2]])
                                   .square;
            if (far < best)
                strip = strip_[item];
            return far;
        });
    return square <= strip ? by_surface : by_tets;
}

} // namespace wct::domain
