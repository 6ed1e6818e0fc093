// Swapping edges and facets: the operators that keep every vertex.

#include "search/operators.h"

#include <algorithm>
#include <limits>

namespace wct::search {

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kLargestRing = 9;
/// Cosine of the angle between two facets up to which they are swapped, and where one of them is beyond the tolerance:
/// at the bottom of a slot the right facets turn by much.
constexpr double kTurn = 0.8;
constexpr double kTurnBeyond = 0.3;
} // namespace

void Operators::add_triangles(const Fan &fan, int a, int b, int i, int j) {
    const std::vector<int> &p = fan.polygon;
    for (int k = i + 1; k < j; ++k) {
        const Tet below{p[i], p[k], p[j], b}, above{p[j], p[k], p[i], a};
        if (!SearchEnergy::positive(complex_, below) || !SearchEnergy::positive(complex_, above))
            continue;
        candidates_.push_back(below);
        candidates_.push_back(above);
        pairs_.push_back(fan.triangle(i, k, j));
    }
}

bool Operators::measure_triangles(Fan &fan, double limit) {
    energies_.resize(candidates_.size());
    energy_.of(complex_, candidates_, energies_.data());
    bool any = false;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        const double energy = energies_[2 * k] + energies_[2 * k + 1];
        any = any || energy < limit;
        fan.pair[pairs_[k]] = energy < limit ? energy : kInfinity;
    }
    candidates_.clear();
    pairs_.clear();
    return any;
}

double Operators::choose_triangles(Fan &fan) {
    const int n = fan.corners();
    fan.cost.assign(static_cast<std::size_t>(n) * n, 0.0);
    fan.choice.assign(static_cast<std::size_t>(n) * n, -1);
    for (int length = 2; length < n; ++length)
        for (int i = 0; i + length < n; ++i) {
            const int j = i + length;
            double best = kInfinity;
            for (int k = i + 1; k < j; ++k) {
                const double cost = fan.cost[i * n + k] + fan.cost[k * n + j] + fan.pair[fan.triangle(i, k, j)];
                if (cost < best) {
                    best = cost;
                    fan.choice[i * n + j] = k;
                }
            }
            fan.cost[i * n + j] = best;
        }
    return fan.cost[n - 1];
}

/// No energy is negative: a triangle that costs `limit` by itself is in no such plan, and every plan has a triangle on
/// the polygon's closing edge. Those are measured first, and mostly that is the end of it.
bool Operators::plan(Fan &fan, int a, int b, double limit) {
    const int n = fan.corners();
    fan.pair.assign(static_cast<std::size_t>(n) * n * n, kInfinity);
    fan.wanted.assign(static_cast<std::size_t>(n) * n, false);
    candidates_.clear();
    pairs_.clear();
    add_triangles(fan, a, b, 0, n - 1);
    if (!measure_triangles(fan, limit))
        return false;
    for (int k = 1; k < n - 1; ++k)
        if (fan.pair[fan.triangle(0, k, n - 1)] < kInfinity)
            fan.wanted[k] = fan.wanted[k * n + n - 1] = true;
    for (int length = n - 2; length >= 2; --length)
        for (int i = 0; i + length < n; ++i) {
            const int j = i + length;
            if (!fan.wanted[i * n + j])
                continue;
            add_triangles(fan, a, b, i, j);
            for (int k = i + 1; k < j; ++k)
                fan.wanted[i * n + k] = fan.wanted[k * n + j] = true;
        }
    measure_triangles(fan, limit);
    return choose_triangles(fan) < limit;
}

/// The triangles (i, k, j) of the planned triangulation of a fan's polygon.
template <class Visit> void Operators::each_triangle(const Fan &fan, const Visit &visit) {
    const int n = fan.corners();
    Edge stack[2 * kLargestRing];
    int top = 0;
    stack[top++] = {0, n - 1};
    while (top) {
        const auto [i, j] = stack[--top];
        if (j - i < 2)
            continue;
        const int k = fan.choice[i * n + j];
        visit(i, k, j);
        stack[top++] = {i, k};
        stack[top++] = {k, j};
    }
}

bool Operators::joined(int a, int b) const {
    const std::vector<int> &star = complex_.star(a);
    return std::any_of(star.begin(), star.end(), [&](int t) { return complex_.has(t, b); });
}

bool Operators::repeats(const Fan &fan) const {
    bool found = false;
    each_triangle(fan, [&](int i, int k, int j) {
        for (const auto &[p, q] : {Edge{i, k}, Edge{k, j}})
            found = found || (q - p > 1 && joined(fan.polygon[p], fan.polygon[q]));
    });
    return found;
}

void Operators::take_planned(const Fan &fan, int a, int b) {
    const std::vector<int> &p = fan.polygon;
    candidates_.clear();
    each_triangle(fan, [&](int i, int k, int j) {
        candidates_.push_back({p[i], p[k], p[j], b});
        candidates_.push_back({p[j], p[k], p[i], a});
    });
}

void Operators::carry_out(const Fan &fan, int a, int b) {
    const int region = complex_.region(fan.tets[0]);
    for (int t : fan.tets)
        complex_.remove_tet(t);
    take_planned(fan, a, b);
    energies_.resize(candidates_.size());
    energy_.of(complex_, candidates_, energies_.data());
    for (std::size_t k = 0; k < candidates_.size(); ++k)
        complex_.add_tet(candidates_[k], region, energies_[k]);
    for (int v : fan.polygon)
        touch(v);
}

bool Operators::beyond(int a, int b, int r, int s) const {
    return complex_.over(sorted(a, b, r)) > 0.0 || complex_.over(sorted(a, b, s)) > 0.0;
}

bool Operators::allows_swap(int a, int b, int r, int s, int patch) {
    watch_.clear();
    watch_.goes(sorted(a, b, r));
    watch_.goes(sorted(a, b, s));
    watch_.comes(sorted(a, r, s), patch);
    watch_.comes(sorted(b, r, s), patch);
    return watch_.allows_replacing();
}

bool Operators::flips_surface(int a, int b, int r, int s, int patch) {
    if (joined(r, s))
        return false; // the surface would pinch
    const Vec3 &pa = complex_.point(a), &pb = complex_.point(b), &pr = complex_.point(r), &ps = complex_.point(s);
    const Vec3 first = cross(pr - pa, ps - pa);
    const Vec3 second = cross(ps - pb, pr - pb);
    const double turn = beyond(a, b, r, s) ? kTurnBeyond : kTurn;
    if (dot(first, second) < turn * norm(first) * norm(second))
        return false;
    return allows_swap(a, b, r, s, patch);
}

bool Operators::cut_ear(int a, int b, double slack) {
    const int t = ring_.tets[0], r = ring_.link[0], s = ring_.link[1];
    const int patch = complex_.patch_of(a, b, r);
    if (!flip_surface || patch < 0 || fixes(patch) || complex_.patch_of(a, b, s) != patch || complex_.is_crease(r, s) ||
        !beyond(a, b, r, s))
        return false;
    // With an edge inside between r and s, and so tets behind both facets, no vertex is lost and nothing pinches.
    if (!ring(r, s, ring_) || !ring_.closed ||
        std::any_of(ring_.link.begin(), ring_.link.end(), [&](int v) { return complex_.is_surface(r, s, v); }))
        return false;
    if (!allows_swap(a, b, r, s, patch) ||
        !(energy_.form().over_weight * watch_.cost(nullptr) < complex_.energy(t) + slack))
        return false;
    const int behind[2] = {complex_.across(t, a, r, s), complex_.across(t, b, r, s)};
    watch_.replace();
    complex_.remove_tet(t);
    for (int u : behind)
        complex_.set_energy(u, energy_.of_present(complex_, complex_.tet(u)));
    WCT_CHECK(complex_.checks.did("cut_ear");)
    for (int v : {a, b, r, s})
        touch(v);
    return true;
}

bool Operators::find_edge_facets(int a, int b, EdgeFacets &facets) const {
    if (complex_.vertex(a).stratum == Stratum::interior || complex_.vertex(b).stratum == Stratum::interior)
        return ring_.closed;
    for (int k = 0; k < static_cast<int>(ring_.link.size()); ++k) {
        const int here = complex_.patch_of(a, b, ring_.link[k]);
        if (here < 0)
            continue;
        if (facets.count++ == 0)
            facets.patch = here;
        else if (here != facets.patch)
            return false;
        facets.last = k;
    }
    if (facets.count == 0)
        return ring_.closed;
    return facets.count == 2 && flip_surface && !fixes(facets.patch);
}

std::size_t Operators::cut_fans(const EdgeFacets &facets) {
    if (!ring_.closed || facets.count == 0) {
        fans_[0].polygon = ring_.link;
        fans_[0].tets = ring_.tets;
        return 1;
    }
    const int second = facets.last; // the first facet is where the ring starts
    fans_[0].polygon.assign(ring_.link.begin(), ring_.link.begin() + second + 1);
    fans_[0].tets.assign(ring_.tets.begin(), ring_.tets.begin() + second);
    fans_[1].polygon.assign(ring_.link.begin() + second, ring_.link.end());
    fans_[1].polygon.push_back(ring_.link[0]);
    fans_[1].tets.assign(ring_.tets.begin() + second, ring_.tets.end());
    return 2;
}

bool Operators::plan_all(std::span<Fan> fans, int a, int b, double limit) {
    std::size_t fresh = 0;
    for (const Fan &fan : fans) {
        if (fan.corners() < 3 || fan.corners() > kLargestRing)
            return false;
        fresh += 2 * (fan.polygon.size() - 2);
    }
    if (!has_room(ring_.tets.size(), fresh))
        return false;
    double after = 0.0;
    for (Fan &fan : fans) {
        if (!plan(fan, a, b, limit - after))
            return false;
        after += fan.cost[fan.polygon.size() - 1];
    }
    return true;
}

bool Operators::remove_edge(int a, int b, double slack) {
    if (complex_.is_crease(a, b) || !ring(a, b, ring_))
        return false;
    const std::size_t n = ring_.link.size();
    if (n == 2)
        return !ring_.closed && cut_ear(a, b, slack);
    EdgeFacets facets;
    if (n > 2 * kLargestRing || !find_edge_facets(a, b, facets))
        return false;
    const std::span fans(fans_, cut_fans(facets));
    if (!plan_all(fans, a, b, sum_of(ring_.tets) + slack))
        return false;
    // The one facet between three edges that stay; all others have a new edge, which repeats looks for.
    if (n == 3 && ring_.closed) {
        take_planned(fans_[0], a, b);
        if (!candidates_fit(ring_.tets))
            return false;
    }
    if (std::any_of(fans.begin(), fans.end(), [this](const Fan &fan) { return repeats(fan); }))
        return false;
    if (facets.count == 2) {
        if (!flips_surface(a, b, fans_[0].polygon.front(), fans_[0].polygon.back(), facets.patch))
            return false;
        watch_.replace();
    }
    for (const Fan &fan : fans)
        carry_out(fan, a, b); // measures the energies with the new facets in place
    WCT_CHECK(complex_.checks.did("remove_edge");)
    touch(a);
    touch(b);
    return true;
}

bool Operators::flip_23(int t, int i, double slack) {
    const Tet tet = complex_.tet(t);
    const int b = tet[i];
    const auto [x, y, z] = inward_facet(tet, i); // winds towards b
    if (complex_.is_surface(x, y, z))
        return false;
    const int s = complex_.across(t, x, y, z);
    if (s < 0 || !has_room(2, 3))
        return false;
    int a = -1;
    for (int v : complex_.tet(s))
        if (v != x && v != y && v != z)
            a = v;
    const Tet three[3] = {{a, b, x, y}, {a, b, y, z}, {a, b, z, x}};
    double energies[3];
    if (!energy_.below(complex_, three, complex_.energy(t) + complex_.energy(s) + slack, energies) || joined(a, b))
        return false;
    const int region = complex_.region(t);
    complex_.remove_tet(t);
    complex_.remove_tet(s);
    for (int k = 0; k < 3; ++k)
        complex_.add_tet(three[k], region, energies[k]);
    WCT_CHECK(complex_.checks.did("flip_23");)
    for (int v : {a, b, x, y, z})
        touch(v);
    return true;
}

} // namespace wct::search
