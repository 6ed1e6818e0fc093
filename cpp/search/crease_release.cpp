#include "search/crease_release.h"

#include "base/sort_unique.h"
#include "geometry/triangle_edges.h"

#include <algorithm>

namespace wct::search {

namespace {

constexpr double kReach = 2.5; // from the middle of a bad tet, in sizes: creases so near are released

} // namespace

SearchOutcome CreaseRelease::run(const SearchOptions &options, const SearchProgress &progress) {
    SearchOutcome sum;
    SearchOptions now = options;
    for (bool more = true;; ++now.seed) {
        const SurfaceGuide guide({surface_.points, surface_.triangles, surface_.patch, surface_.segments,
                                  surface_.curve, surface_.flat, surface_.local},
                                 tolerance_, spacing_);
        const std::vector<std::uint8_t> may = releasable(guide);
        more = more && std::find(may.begin(), may.end(), 1) != may.end();
        now.hurry = more; // what creases hold up seldom comes right by waiting
        LocalSearch search(complex_, guide, now);
        const SearchOutcome one = search.run(progress);
        sum.bad = one.bad;
        sum.stuck = one.stuck;
        sum.passes += one.passes;
        sum.kicks += one.kicks;
        sum.accepted += one.accepted;
        sum.evaluations += one.evaluations;
        sum.work += one.work;
        now.work = std::max(0L, options.work - sum.work);
        sum.stopped = one.stopped;
        if (one.stuck.empty() || one.stopped || !more)
            return sum;
        const std::vector<int> curves = near(one.stuck, may);
        more = !curves.empty(); // else once more, with all patience
        if (more)
            release(curves);
    }
}

std::vector<std::uint8_t> CreaseRelease::releasable(const SurfaceGuide &guide) const {
    std::vector<std::uint8_t> may(surface_.loose.size(), 0);
    for (const int c : surface_.curve)
        may[c] = surface_.loose[c] && !guide.exact(c);
    return may;
}

std::vector<int> CreaseRelease::near(const std::vector<int> &bad, const std::vector<std::uint8_t> &may) const {
    std::vector<int> out;
    for (const auto &[edge, curve] : complex_.creases()) {
        if (!may[curve])
            continue;
        const Vec3 middle = 0.5 * (complex_.point(edge[0]) + complex_.point(edge[1]));
        const double reach = kReach * 0.5 * (complex_.vertex(edge[0]).size + complex_.vertex(edge[1]).size);
        if (std::any_of(bad.begin(), bad.end(), [&](int t) { return norm(complex_.centroid(t) - middle) < reach; }))
            out.push_back(curve);
    }
    sort_unique(out);
    return out;
}

void CreaseRelease::release(const std::vector<int> &curves) {
    std::vector<std::uint8_t> gone(surface_.loose.size(), false);
    for (const int c : curves)
        gone[c] = true;
    released_.insert(released_.end(), curves.begin(), curves.end());
    std::sort(released_.begin(), released_.end());

    const std::vector<int> patch_of = join_patches(gone);
    for (int &p : surface_.patch)
        p = patch_of[p];
    relabel(gone, patch_of);
    std::size_t kept = 0;
    for (std::size_t s = 0; s < surface_.segments.size(); ++s)
        if (!gone[surface_.curve[s]]) {
            surface_.segments[kept] = surface_.segments[s];
            surface_.curve[kept++] = surface_.curve[s];
        }
    surface_.segments.resize(kept);
    surface_.curve.resize(kept);
}

std::vector<int> CreaseRelease::join_patches(const std::vector<std::uint8_t> &gone) const {
    std::vector<Edge> edges;
    for (std::size_t s = 0; s < surface_.segments.size(); ++s)
        if (gone[surface_.curve[s]])
            edges.push_back(sorted(surface_.segments[s][0], surface_.segments[s][1]));
    std::sort(edges.begin(), edges.end());
    return geometry::joined_patches(surface_.patch, geometry::TriangleEdges(surface_.triangles), edges);
}

void CreaseRelease::relabel(const std::vector<std::uint8_t> &gone, const std::vector<int> &patch_of) {
    const std::vector<int> sheets =
        geometry::sheets_at(surface_.triangles, geometry::TriangleEdges(surface_.triangles), surface_.points.size());
    std::vector<int> held(complex_.vertex_slots(), 0), freed(complex_.vertex_slots(), 0);
    for (const auto &[edge, curve] : complex_.creases())
        for (const int v : edge)
            ++(gone[curve] ? freed : held)[v];

    TetComplex next;
    std::vector<TetComplex::SurfaceAt> facets;
    for (std::size_t k = 0; k < complex_.vertex_slots(); ++k) {
        const int v = static_cast<int>(k);
        Vertex vertex = complex_.vertex(v);
        vertex.hint = 0; // patches and curves will be others
        const bool loose_corner =
            vertex.stratum == Stratum::corner && vertex.label >= 0 && freed[v] && !held[v] && sheets[vertex.label] == 1;
        if ((vertex.stratum == Stratum::crease && gone[vertex.label]) || loose_corner) {
            complex_.surface_at(v, facets);
            vertex.stratum = Stratum::patch;
            vertex.label = facets.empty() ? -1 : facets[0].facet->patch;
        }
        if (vertex.stratum == Stratum::patch && vertex.label >= 0)
            vertex.label = patch_of[vertex.label];
        next.add_vertex(vertex);
    }
    for (std::size_t k = 0; k < complex_.tet_slots(); ++k)
        if (const int t = static_cast<int>(k); complex_.alive(t))
            next.add_tet(complex_.tet(t), complex_.region(t), 0.0);
    for (const auto &[key, patch] : complex_.sorted_surface())
        next.add_facet(key, patch_of[patch]);
    for (const auto &[edge, curve] : complex_.sorted_creases())
        if (!gone[curve])
            next.add_crease(edge, curve);
    complex_ = std::move(next);
}

} // namespace wct::search
