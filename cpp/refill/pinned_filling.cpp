#include "refill/pinned_filling.h"

#include <algorithm>
#include <tuple>

namespace wct::refill {

namespace {

/// Do any of the points have the same place?
bool coincide(std::vector<Vec3> points) {
    const auto key = [](const Vec3 &p) { return std::tie(p.x, p.y, p.z); };
    std::sort(points.begin(), points.end(), [&](const Vec3 &p, const Vec3 &q) { return key(p) < key(q); });
    return std::adjacent_find(points.begin(), points.end()) != points.end();
}

} // namespace

void Keeper::clear(sampling::Cloud &cloud) const {
    std::vector<char> keep(cloud.count(), 1);
    sampling::PointGrid grid;
    for (std::size_t i = 0; i < cloud.count(); ++i) {
        const double radius = least_ * cloud.size[i];
        if (i < first_)
            cloud.points[i] = mesh_.points[facets_.points()[i]]; // the descent rounds
        else
            keep[i] = facets_.clear(cloud.points[i]) && !grid.crowded(cloud.points[i], radius);
        if (keep[i])
            grid.add(cloud.points[i], radius);
    }
    cloud.keep(keep);
}

bool Keeper::triangulate(sampling::Cloud &cloud, sampling::RestrictedDelaunay &complex) const {
    for (bool again = true; again;) {
        complex.all = delaunay::delaunay(cloud.points);
        if (!facets_.label(complex, cloud.points))
            return false;
        std::vector<char> keep(cloud.count(), 0);
        std::fill_n(keep.begin(), first_, 1);
        for (std::size_t t = 0; t < complex.all.tets.size(); ++t)
            if (complex.region[t] >= 0)
                for (const int v : complex.all.tets[t]) {
                    keep[v] = 1;
                    if (cloud.role[v] == Stratum::interior)
                        cloud.label[v] = complex.region[t];
                }
        again = std::find(keep.begin(), keep.end(), 0) != keep.end();
        if (again)
            cloud.keep(keep);
    }
    return true;
}

Refilled merged(const sampling::Cloud &cloud, const sampling::RestrictedDelaunay &complex, const PinnedFacets &facets,
                const domain::InputMesh &mesh, std::span<const double> size) {
    Refilled out;
    std::vector<int> place(mesh.points.size(), -1);
    const auto add = [&](const Vec3 &p, int origin, double length) {
        if (origin >= 0)
            place[origin] = static_cast<int>(out.points.size());
        out.points.push_back(p);
        out.origin.push_back(origin);
        out.size.push_back(length);
    };
    for (std::size_t i = 0; i < cloud.count(); ++i)
        add(cloud.points[i], cloud.role[i] == Stratum::interior ? -1 : cloud.label[i], cloud.size[i]);
    complex.append_inside(out.tets, out.region);
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        if (!facets.keeps(static_cast<int>(t)))
            continue;
        Tet tet = mesh.tets[t];
        for (int &v : tet) {
            if (place[v] < 0)
                add(mesh.points[v], v, size[v]);
            v = place[v];
        }
        out.tets.push_back(tet);
        out.region.push_back(mesh.region[t]);
    }
    return out;
}

Refilled fill_between(const domain::Reference &reference, const domain::InputMesh &mesh,
                      const std::vector<char> &pinned, std::span<const Edge> edges, Monitor &monitor,
                      const std::function<Refilled(const PinnedFacets &, const domain::RegionMap &)> &fill) {
    if (coincide(mesh.points)) // as where sheets touch: no triangulation tells them apart
        return {};
    const domain::RegionMap map(mesh, reference);
    Refilled interior;
    for (const bool squares : {true, false}) {
        if (!interior.tets.empty() || monitor.stopped())
            break;
        const PinnedFacets facets(mesh, reference.data().triangles, pinned, edges, squares);
        if (!facets.keeps_all())
            interior = fill(facets, map);
    }
    interior.stopped = monitor.stopped();
    return interior;
}

} // namespace wct::refill
