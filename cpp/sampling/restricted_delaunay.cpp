#include "sampling/restricted_delaunay.h"

#include "base/disjoint_sets.h"
#include "base/sort_unique.h"
#include "geometry/euler_characteristic.h"
#include "sampling/held_surface.h"
#include "sampling/sheets.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace wct::sampling {

namespace {

constexpr double kFlat = 1e-5;  // altitude per mean edge of a tet that is nothing but rounding
constexpr double kSliver = 0.3; // the same for a tet that rests on a curved patch

/// Smallest altitude per mean edge.
double flatness(const std::vector<Vec3> &points, const Tet &tet) {
    double mean = 0.0;
    double area = 0.0;
    for (const auto &f : kOutward) {
        const Vec3 &a = points[tet[f[0]]];
        area = std::max(area, norm(cross(points[tet[f[1]]] - a, points[tet[f[2]]] - a)));
    }
    for (int i = 0; i < 4; ++i)
        for (int j = i + 1; j < 4; ++j)
            mean += norm(points[tet[j]] - points[tet[i]]) / 6.0;
    const double det = six_volumes(points[tet[0]], points[tet[1]], points[tet[2]], points[tet[3]]);
    // Four points on a line have no altitude worth the name: both det and area are rounding.
    constexpr double line = 1e-9; // twice the largest facet's area, per square of the mean edge
    return area > line * mean * mean ? det / (area * mean) : 0.0;
}

bool share_curved_patch(const Cloud &cloud, const domain::Reference &reference, const Tet &tet) {
    const std::vector<int> shared = shared_patches(cloud, reference, tet);
    return std::any_of(shared.begin(), shared.end(), [&](int p) { return !reference.planar(p); });
}

/// Whether a tet has an edge far longer than wanted, between curved patches: past the crease between two of them.
bool reaches_along(const Cloud &cloud, const domain::Reference &reference, const Tet &tet) {
    constexpr double far = 3.0; // sizes
    if (!std::all_of(tet.begin(), tet.end(), [&](int v) { return on_curved(cloud, reference, v); }))
        return false;
    return std::any_of(std::begin(kEdges), std::end(kEdges), [&](const auto &edge) {
        const int v = tet[edge[0]], w = tet[edge[1]];
        return norm(cloud.points[w] - cloud.points[v]) > far * std::max(cloud.size[v], cloud.size[w]);
    });
}

/// Of a tet on curved patches, the facets whose corners share none: bits by the corner opposite. On the boundary they
/// hide a crease, as a rim where the regions on a smooth side meet.
unsigned hiding_facets(const Cloud &cloud, const domain::Reference &reference, const std::array<int, 4> &tet) {
    if (!std::all_of(tet.begin(), tet.end(), [&](int v) { return on_curved(cloud, reference, v); }))
        return 0;
    unsigned bits = 0;
    for (int i = 0; i < 4; ++i)
        if (shared_patches(cloud, reference, outward_facet(tet, i)).empty())
            bits |= 1u << i;
    return bits;
}

/// Take slivers off curved patches from outside: either two of the facets are on the boundary, and the two others take
/// over, or one is, and the point under it that should be on the surface comes to light. Tets that are astray go where
/// two or more facets are on the boundary.
void peel(const Cloud &cloud, const domain::Reference &reference, RestrictedDelaunay &complex) {
    struct Candidate {
        int tet;
        unsigned hiding; // the only facets that may be on the boundary, two of them; 0: any
        int least;       // so many must be
    };
    std::vector<Candidate> candidates;
    std::vector<int> open(cloud.count(), 0); // per point: its facets on the boundary
    const auto count = [&](int t, int i, int change) {
        for (const int v : complex.facet(t, i))
            open[v] += change;
    };
    for (int t = 0; t < static_cast<int>(complex.all.tets.size()); ++t)
        for (int i = 0; i < 4; ++i)
            if (complex.region[t] >= 0 && complex.beyond(t, i) < 0)
                count(t, i, 1);
    for (int t = 0; t < static_cast<int>(complex.all.tets.size()); ++t) {
        const auto &tet = complex.all.tets[t];
        if (complex.region[t] < 0 ||
            std::any_of(tet.begin(), tet.end(), [&](int v) { return cloud.role[v] == Stratum::interior; }))
            continue;
        if (flatness(cloud.points, tet) < kSliver &&
            (share_curved_patch(cloud, reference, tet) || reaches_along(cloud, reference, tet)))
            candidates.push_back({t, 0, 1});
        else if (is_astray(cloud, reference, tet, complex.region[t]))
            candidates.push_back({t, 0, 2});
        else if (const unsigned hiding = hiding_facets(cloud, reference, tet); std::popcount(hiding) > 1)
            candidates.push_back({t, hiding, 2});
    }
    for (bool again = true; again;) { // tets that were covered may lie open now
        again = false;
        for (auto &[t, hiding, least] : candidates) {
            int outside = 0, facet = -1;
            unsigned bits = 0;
            for (int i = 0; i < 4; ++i)
                if (complex.beyond(t, i) < 0) {
                    ++outside;
                    facet = i;
                    bits |= 1u << i;
                }
            if (hiding && (outside != 2 || (bits & ~hiding)))
                continue;
            if (outside < least || (outside == 1 && open[complex.all.tets[t][facet]] > 0))
                continue;
            for (int i = 0; i < 4; ++i)
                count(t, i, complex.beyond(t, i) < 0 ? -1 : 1);
            complex.region[t] = -1;
            t = -1;
            again = true;
        }
        std::erase_if(candidates, [](const Candidate &one) { return one.tet < 0; });
    }
}

/// The triangles that bound regions, once for each region that they bound.
struct RegionSurfaces {
    std::vector<Facet> triangles;
    std::vector<int> owner; // region of each
};

RegionSurfaces region_surfaces(const RestrictedDelaunay &complex) {
    RegionSurfaces out;
    for (int t = 0; t < static_cast<int>(complex.all.tets.size()); ++t)
        for (int i = 0; i < 4; ++i) {
            if (complex.region[t] < 0 || complex.beyond(t, i) == complex.region[t])
                continue;
            out.triangles.push_back(complex.facet(t, i));
            out.owner.push_back(complex.region[t]);
        }
    return out;
}

struct EdgeUse {
    int region;
    int v, w;
    int triangle;
};

/// Who uses which edge, those of one edge by one region beside each other.
std::vector<EdgeUse> edge_uses(const RegionSurfaces &surfaces) {
    std::vector<EdgeUse> out;
    for (std::size_t k = 0; k < surfaces.triangles.size(); ++k)
        for (int i = 0; i < 3; ++i) {
            const auto [v, w] = std::minmax(surfaces.triangles[k][i], surfaces.triangles[k][(i + 1) % 3]);
            out.push_back({surfaces.owner[k], v, w, static_cast<int>(k)});
        }
    std::sort(out.begin(), out.end(), [](const auto &a, const auto &b) {
        return std::tie(a.region, a.v, a.w, a.triangle) < std::tie(b.region, b.v, b.w, b.triangle);
    });
    return out;
}

/// Join the triangles' corners (three times the triangle, and which) into fans, across edges that two triangles of a
/// region use; the ends of all other edges are pinched.
DisjointSets join_fans(const RegionSurfaces &surfaces, std::vector<int> &pinched) {
    const std::vector<EdgeUse> uses = edge_uses(surfaces);
    DisjointSets fans(3 * surfaces.triangles.size());
    const auto corner = [&](int triangle, int v) {
        const Facet &f = surfaces.triangles[triangle];
        return 3 * triangle + static_cast<int>(std::find(f.begin(), f.end(), v) - f.begin());
    };
    for (std::size_t k = 0, end = 0; k < uses.size(); k = end) {
        const auto &[region, v, w, triangle] = uses[k];
        for (end = k + 1; end < uses.size() && uses[end].region == region && uses[end].v == v && uses[end].w == w;)
            ++end;
        if (end - k != 2) {
            pinched.insert(pinched.end(), {v, w});
            continue;
        }
        for (const int at : {v, w})
            fans.join(corner(triangle, at), corner(uses[k + 1].triangle, at));
    }
    return fans;
}

/// Points are pinched, too, where a region has more than one fan.
void find_double_fans(const RegionSurfaces &surfaces, DisjointSets &fans, std::vector<int> &pinched) {
    std::map<std::pair<int, int>, int> first; // (region, point) -> its first fan
    for (std::size_t k = 0; k < 3 * surfaces.triangles.size(); ++k) {
        const int v = surfaces.triangles[k / 3][k % 3], fan = fans.find(static_cast<int>(k));
        const auto [at, fresh] = first.try_emplace({surfaces.owner[k / 3], v}, fan);
        if (!fresh && at->second != fan)
            pinched.push_back(v);
    }
}

} // namespace

Facet RestrictedDelaunay::facet(int t, int i) const {
    return outward_facet(all.tets[t], i);
}

void RestrictedDelaunay::append_inside(std::vector<Tet> &tets, std::vector<int> &regions) const {
    for (std::size_t t = 0; t < all.tets.size(); ++t)
        if (region[t] >= 0) {
            tets.push_back(all.tets[t]);
            regions.push_back(region[t]);
        }
}

RestrictedDelaunay labelled_delaunay(const Cloud &cloud, const domain::RegionMap &map, const Workers &workers,
                                     const HeldSurface *held, delaunay::MovingDelaunay *moving) {
    RestrictedDelaunay complex{moving ? moving->of(cloud.points, workers) : delaunay::delaunay(cloud.points), {}, {}};
    if (held)
        held->recover(cloud, complex.all);
    const auto &tets = complex.all.tets;
    complex.region.resize(tets.size());
    workers.for_each(tets.size(), 1024, [&](std::size_t t) {
        int on_surface = 0, inner = -1, near = -1;
        for (const int v : tets[t])
            if (cloud.role[v] == Stratum::interior) {
                inner = v;
            } else {
                ++on_surface;
                near = std::max(near, cloud.near[v]);
            }
        if (on_surface <= 1) {
            complex.region[t] = cloud.label[inner];
            return;
        }
        if (on_surface == 4 && flatness(cloud.points, tets[t]) < kFlat) {
            complex.region[t] = -1;
            return;
        }
        complex.region[t] = map.region(cloud.centroid(tets[t]), near);
    });
    if (held)
        held->label(cloud, complex);
    return complex;
}

RestrictedDelaunay restricted_delaunay(const Cloud &cloud, const domain::Reference &reference,
                                       const domain::RegionMap &map, const Workers &workers, const HeldSurface *held,
                                       delaunay::MovingDelaunay *moving) {
    RestrictedDelaunay complex = labelled_delaunay(cloud, map, workers, held, moving);
    peel(cloud, reference, complex);
    if (held)
        held->label(cloud, complex);
    find_sheets(cloud, reference, complex, workers);
    return complex;
}

std::vector<Facet> surface_facets(const RestrictedDelaunay &complex) {
    std::vector<Facet> facets;
    for (int t = 0; t < static_cast<int>(complex.all.tets.size()); ++t)
        for (int i = 0; i < 4; ++i)
            if (complex.on_surface(t, i))
                facets.push_back(complex.facet(t, i));
    return facets;
}

std::vector<Edge> surface_edges(const RestrictedDelaunay &complex) {
    std::vector<Edge> edges;
    for (const auto &f : surface_facets(complex))
        for (int k = 0; k < 3; ++k)
            edges.push_back(sorted(f[k], f[(k + 1) % 3]));
    sort_unique(edges);
    return edges;
}

Flaws find_flaws(const Cloud &cloud, const RestrictedDelaunay &complex) {
    Flaws flaws;
    const RegionSurfaces surfaces = region_surfaces(complex);
    for (const Facet &f : surfaces.triangles)
        for (const int v : f)
            if (cloud.role[v] == Stratum::interior)
                flaws.exposed.push_back(v);
    DisjointSets fans = join_fans(surfaces, flaws.pinched);
    find_double_fans(surfaces, fans, flaws.pinched);
    sort_unique(flaws.exposed);
    sort_unique(flaws.pinched);
    return flaws;
}

std::vector<int> euler_characteristics(const RestrictedDelaunay &complex, const Flaws &flaws) {
    if (!flaws.pinched.empty())
        return geometry::euler_characteristics(complex.all.tets, complex.region);
    const RegionSurfaces surfaces = region_surfaces(complex);
    const int most = surfaces.owner.empty() ? -1 : *std::max_element(surfaces.owner.begin(), surfaces.owner.end());
    std::vector<int> sum(most + 1, 0); // twice its surface's vertices less its triangles: each edge is on two of these
    std::vector<std::array<int, 2>> corners; // region and point
    for (std::size_t k = 0; k < surfaces.triangles.size(); ++k) {
        --sum[surfaces.owner[k]];
        for (const int v : surfaces.triangles[k])
            corners.push_back({surfaces.owner[k], v});
    }
    sort_unique(corners);
    for (const auto &[region, v] : corners)
        sum[region] += 2;
    for (int &one : sum)
        one /= 4;
    return sum;
}

} // namespace wct::sampling
