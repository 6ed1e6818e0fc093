// Adding a vertex on an edge, or where a facet is farthest from the surface.

#include "search/operators.h"

#include <algorithm>

namespace wct::search {

std::optional<Vec3> Operators::farthest(const Facet &key) const {
    if (complex_.over(key) <= 0.0)
        return std::nullopt;
    std::optional<Vec3> worst;
    double most = guide_.tolerance();
    const std::array<Vec3, 3> corners = complex_.corners(key);
    for (int l = complex_.facet(key).landmark; l >= 0; l = complex_.next_landmark(l)) {
        const Vec3 &point = guide_.landmarks()[l].point;
        const double distance = guide_.strict(l) * norm(point - geometry::closest_on(corners, point));
        if (distance > most) {
            most = distance;
            worst = point;
        }
    }
    if (worst)
        return worst;
    SurfaceHints hints = complex_.facet(key).hints;
    const auto gap = guide_.gap(complex_.patch_of(key[0], key[1], key[2]), corners, hints);
    if (gap.distance <= guide_.tolerance())
        return std::nullopt;
    const Vec3 &w = gap.weights;
    return w.x * corners[0] + w.y * corners[1] + w.z * corners[2] + gap.to_surface;
}

std::optional<int> Operators::refine(const Facet &key, const Vec3 &peak, double slack) {
    constexpr double rounding = 1.0 + 1e-9;
    if (const auto v = insert_on_surface(key, peak, slack))
        return v;
    const std::array<Vec3, 3> corners = complex_.corners(key);
    const Vec3 off = peak - geometry::closest_on(corners, peak);
    for (int k = 0; k < 3; ++k) {
        const Vec3 beyond = peak - geometry::closest_on(std::array{corners[k], corners[(k + 1) % 3]}, peak);
        if (dot(beyond, beyond) > rounding * dot(off, off))
            continue;
        if (const auto v = split(key[k], key[(k + 1) % 3], slack))
            return v;
    }
    return std::nullopt;
}

Vertex Operators::middle_vertex(int a, int b, const std::vector<SplitFacet> &facets) const {
    Vertex middle;
    middle.position = 0.5 * (complex_.point(a) + complex_.point(b));
    middle.size = 0.5 * (complex_.vertex(a).size + complex_.vertex(b).size);
    if (const int curve = complex_.curve_of(a, b); curve >= 0) {
        middle.stratum = Stratum::crease;
        middle.label = curve;
        middle.needle = std::max(complex_.vertex(a).needle, complex_.vertex(b).needle);
    } else if (!facets.empty()) {
        middle.stratum = Stratum::patch;
        middle.label = facets[0].patch;
        middle.hint = complex_.facet(sorted(a, b, facets[0].apex)).hints[0];
        for (const SplitFacet &facet : facets)
            if (const auto peak = farthest(sorted(a, b, facet.apex)))
                middle.position = *peak;
    }
    guide_.admit(middle, middle.position);
    return middle;
}

double Operators::halve_tets(int a, int b, int v) {
    double before = 0.0;
    candidates_.clear();
    regions_.clear();
    for (std::size_t k = 0; k < ring_.tets.size(); ++k) {
        const auto [p, q] = ring_.opposite[k];
        before += complex_.energy(ring_.tets[k]);
        candidates_.push_back({a, v, p, q});
        candidates_.push_back({v, b, p, q});
        regions_.insert(regions_.end(), 2, complex_.region(ring_.tets[k]));
    }
    return before;
}

bool Operators::splits(int a, int b, std::vector<SplitFacet> &facets) const {
    for (int v : ring_.link)
        if (const int patch = complex_.patch_of(a, b, v); patch >= 0) {
            if (fixes(patch))
                return false;
            facets.push_back({v, patch});
        }
    const int curve = complex_.curve_of(a, b);
    return (curve < 0 && facets.empty()) || (split_surface && !(curve >= 0 && fixes_curve(curve)));
}

std::optional<int> Operators::split(int a, int b, double slack) {
    const double size = 0.5 * (complex_.vertex(a).size + complex_.vertex(b).size);
    if (norm(complex_.point(a) - complex_.point(b)) < 2.0 * shortest * size || !fans(a, b, ring_))
        return std::nullopt;
    std::vector<SplitFacet> facets;
    if (!splits(a, b, facets))
        return std::nullopt;
    const int v = complex_.add_vertex(middle_vertex(a, b, facets));
    const double before = halve_tets(a, b, v);
    if (!has_room(ring_.tets.size(), candidates_.size()) || !candidates_below(before + slack))
        return std::nullopt;
    watch_.clear();
    for (const auto &[apex, patch] : facets) {
        watch_.goes(sorted(a, b, apex));
        watch_.comes(sorted(a, v, apex), patch);
        watch_.comes(sorted(v, b, apex), patch);
    }
    if (!watch_.allows_replacing())
        return std::nullopt;
    if (watch_.replace())
        energy_.of(complex_, candidates_, energies_.data());
    replace_tets(ring_.tets);
    if (const int curve = complex_.curve_of(a, b); curve >= 0) {
        complex_.remove_crease(sorted(a, b));
        complex_.add_crease(sorted(a, v), curve);
        complex_.add_crease(sorted(v, b), curve);
    }
    WCT_CHECK(complex_.checks.did("split");)
    for (int w : {v, a, b})
        touch(w);
    for (int w : ring_.link)
        touch(w);
    return v;
}

} // namespace wct::search
