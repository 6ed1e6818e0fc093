// Adding a vertex: on an edge, or in the middle of a cavity.

#include "operators.h"

#include <algorithm>

namespace wct {

/// The landmark farthest from the facets at edge ab that are beyond the tolerance: a vertex there covers it best.
std::optional<Vec3> Operators::uncovered_beside(int a, int b, const std::vector<int> &apices) const {
    std::optional<Vec3> worst;
    double farthest = guide_.tolerance();
    for (int apex : apices) {
        const Facet key = sorted(a, b, apex);
        if (complex_.over(key) <= 0.0)
            continue;
        const std::array<Vec3, 3> corners = complex_.corners(key);
        for (int l = complex_.first_landmark(key); l >= 0; l = complex_.next_landmark(l)) {
            const Vec3 &point = guide_.landmarks()[l].point;
            const double distance = norm(point - closest_on(corners, point));
            if (distance > farthest) {
                farthest = distance;
                worst = point;
            }
        }
    }
    return worst;
}

std::optional<int> Operators::split(int a, int b, double slack) {
    const double size = 0.5 * (complex_.vertex(a).size + complex_.vertex(b).size);
    if (norm(complex_.point(a) - complex_.point(b)) < 2.0 * shortest * size || !ring(a, b, ring_))
        return std::nullopt;
    Vertex middle;
    middle.position = 0.5 * (complex_.point(a) + complex_.point(b));
    middle.size = size;
    std::vector<int> facet_apices;
    std::vector<int> facet_patches;
    for (int v : ring_.link) {
        const int patch = complex_.patch_of(a, b, v);
        if (patch < 0)
            continue;
        facet_apices.push_back(v);
        facet_patches.push_back(patch);
    }
    const int curve = complex_.curve_of(a, b);
    if ((curve >= 0 || !facet_patches.empty()) && !split_surface)
        return std::nullopt;
    if (curve >= 0) {
        middle.stratum = Stratum::crease;
        middle.label = curve;
    } else if (!facet_patches.empty()) {
        middle.stratum = Stratum::patch;
        middle.label = facet_patches[0];
    }
    if (middle.stratum == Stratum::patch)
        if (const auto peak = uncovered_beside(a, b, facet_apices))
            middle.position = *peak;
    if (!guide_.admit(middle, middle.position))
        return std::nullopt;
    const int v = complex_.add_vertex(middle);
    double before = 0.0;
    candidates_.clear();
    regions_.clear();
    for (std::size_t k = 0; k < ring_.tets.size(); ++k) {
        const int p = ring_.link[k];
        const int q = ring_.link[(k + 1) % ring_.link.size()];
        before += complex_.energy(ring_.tets[k]);
        candidates_.push_back({a, v, p, q});
        candidates_.push_back({v, b, p, q});
        regions_.push_back(complex_.region(ring_.tets[k]));
    }
    if (!candidates_below(before + slack))
        return std::nullopt;
    watch_.clear();
    for (std::size_t k = 0; k < facet_apices.size(); ++k) {
        watch_.goes(sorted(a, b, facet_apices[k]), facet_patches[k]);
        watch_.comes(sorted(a, v, facet_apices[k]), facet_patches[k]);
        watch_.comes(sorted(v, b, facet_apices[k]), facet_patches[k]);
    }
    if (!watch_.allows_replacing())
        return std::nullopt;
    if (watch_.replace())
        energy_.of(complex_, candidates_, energies_.data());
    for (int t : ring_.tets)
        complex_.remove_tet(t);
    for (std::size_t k = 0; k < candidates_.size(); ++k)
        complex_.add_tet(candidates_[k], regions_[k / 2], energies_[k]);
    if (curve >= 0) {
        complex_.remove_crease(sorted(a, b));
        complex_.add_crease(sorted(a, v), curve);
        complex_.add_crease(sorted(v, b), curve);
    }
    touch(v);
    touch(a);
    touch(b);
    for (int w : ring_.link)
        touch(w);
    return v;
}

std::optional<int> Operators::insert(int t0, const Vec3 &x, double slack) {
    constexpr std::size_t largest = 60;
    const auto in_circumsphere = [&](int t) {
        const Tet &tet = complex_.tet(t);
        const Vec3 &o = complex_.point(tet[0]);
        const Vec3 u = complex_.point(tet[1]) - o, v = complex_.point(tet[2]) - o, w = complex_.point(tet[3]) - o;
        const Vec3 a = cross(v, w), b = cross(w, u), c = cross(u, v);
        const double det = dot(u, a);
        if (det <= 0.0)
            return false;
        const Vec3 r = (0.5 / det) * (dot(u, u) * a + dot(v, v) * b + dot(w, w) * c);
        const Vec3 d = x - o - r;
        return dot(d, d) < dot(r, r);
    };
    std::vector<int> cavity{t0};
    struct Wall {
        Tet tet; // with the new vertex in place of a corner
    };
    const auto in_cavity = [&](int t) { return std::find(cavity.begin(), cavity.end(), t) != cavity.end(); };
    const auto across = [&](const Tet &tet, int t, int i) {
        const int p = tet[kFacets[i][0]], q = tet[kFacets[i][1]], r = tet[kFacets[i][2]];
        return complex_.patch_of(p, q, r) >= 0 ? -1 : complex_.across(t, p, q, r);
    };
    for (std::size_t k = 0; k < cavity.size(); ++k) {
        const int t = cavity[k];
        const Tet tet = complex_.tet(t);
        for (int i = 0; i < 4; ++i) {
            const int s = across(tet, t, i);
            if (s < 0 || in_cavity(s) || !in_circumsphere(s))
                continue;
            cavity.push_back(s);
            if (cavity.size() > largest)
                return std::nullopt;
        }
    }
    Vertex vertex;
    vertex.position = x;
    for (int v : complex_.tet(t0))
        vertex.size += 0.25 * complex_.vertex(v).size;
    const int region = complex_.region(t0);
    const int v = complex_.add_vertex(vertex);
    candidates_.clear();
    double before = 0.0;
    std::vector<int> inside;
    std::vector<int> wall;
    for (int t : cavity) {
        before += complex_.energy(t);
        const Tet tet = complex_.tet(t);
        inside.insert(inside.end(), tet.begin(), tet.end());
        for (int i = 0; i < 4; ++i) {
            const int s = across(tet, t, i);
            if (s >= 0 && in_cavity(s))
                continue;
            Tet coned = tet;
            coned[i] = v;
            candidates_.push_back(coned);
            for (int k = 0; k < 3; ++k) {
                const int w = tet[kFacets[i][k]];
                wall.push_back(w);
                if (norm(complex_.point(w) - x) < shortest * vertex.size)
                    return std::nullopt;
            }
        }
    }
    for (int w : inside)
        if (std::find(wall.begin(), wall.end(), w) == wall.end())
            return std::nullopt; // w would be left without a tet
    if (!candidates_below(before + slack))
        return std::nullopt;
    for (int t : cavity)
        complex_.remove_tet(t);
    for (std::size_t k = 0; k < candidates_.size(); ++k)
        complex_.add_tet(candidates_[k], region, energies_[k]);
    for (const Tet &tet : candidates_)
        for (int w : tet)
            touch(w);
    return v;
}

} // namespace wct
