#include "operators.h"

#include <algorithm>
#include <limits>

namespace wct {

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kLargestRing = 9;

/// Corners k, l such that (i, j, k, l) is an even permutation.
constexpr int kRest[4][4][2] = {{{-1, -1}, {2, 3}, {3, 1}, {1, 2}},
                                {{3, 2}, {-1, -1}, {0, 3}, {2, 0}},
                                {{1, 3}, {3, 0}, {-1, -1}, {0, 1}},
                                {{2, 1}, {0, 2}, {1, 0}, {-1, -1}}};

int corner_of(const Tet &tet, int v) {
    int i = 0;
    while (tet[i] != v)
        ++i;
    return i;
}

} // namespace

void Operators::touch(int v) {
    if (std::find(touched.begin(), touched.end(), v) == touched.end())
        touched.push_back(v);
}

bool Operators::ring(int a, int b, Ring &ring) const {
    ring.link.clear();
    ring.tets.clear();
    ring.closed = true;
    int from[64];
    int to[64];
    int tets[64];
    int count = 0;
    for (int t : complex_.star(a)) {
        if (!complex_.has(t, b))
            continue;
        if (count == 64)
            return false;
        const Tet &tet = complex_.tet(t);
        const int *rest = kRest[corner_of(tet, a)][corner_of(tet, b)];
        from[count] = tet[rest[0]];
        to[count] = tet[rest[1]];
        tets[count++] = t;
    }
    if (count == 0)
        return false;
    int start = from[0];
    for (int k = 0; k < count; ++k) // a link vertex nobody leads to starts an open fan
        if (std::find(to, to + count, from[k]) == to + count) {
            if (!ring.closed)
                return false; // two fans touch in this edge
            ring.closed = false;
            start = from[k];
        }
    if (ring.closed) // start a ring through an interface at one of its facets
        for (int k = 0; k < count; ++k)
            if (complex_.patch_of(a, b, from[k]) >= 0) {
                start = from[k];
                break;
            }
    int current = start;
    ring.link.push_back(start);
    for (int k = 0; k < count; ++k) {
        const int *found = std::find(from, from + count, current);
        if (found == from + count)
            return false;
        ring.tets.push_back(tets[found - from]);
        current = to[found - from];
        if (k + 1 < count || !ring.closed)
            ring.link.push_back(current);
        if (current == start && k + 1 < count)
            return false;
    }
    return !ring.closed || current == start;
}

void Operators::surface_at(int v, std::vector<Facet> &facets, std::vector<int> &patches) const {
    facets.clear();
    patches.clear();
    if (complex_.vertex(v).stratum == Stratum::interior)
        return;
    for (int t : complex_.star(v)) {
        const Tet &tet = complex_.tet(t);
        for (int i = 0; i < 4; ++i) {
            if (tet[i] == v)
                continue;
            const Facet key = sorted(tet[kFacets[i][0]], tet[kFacets[i][1]], tet[kFacets[i][2]]);
            const int patch = complex_.patch_of(key[0], key[1], key[2]);
            if (patch >= 0 && std::find(facets.begin(), facets.end(), key) == facets.end()) {
                facets.push_back(key);
                patches.push_back(patch);
            }
        }
    }
}

bool Operators::plan(Fan &fan, int a, int b) {
    const int n = static_cast<int>(fan.polygon.size());
    const std::vector<int> &p = fan.polygon;
    candidates_.clear();
    for (int i = 0; i < n; ++i)
        for (int k = i + 1; k < n; ++k)
            for (int j = k + 1; j < n; ++j) {
                candidates_.push_back({p[i], p[k], p[j], b});
                candidates_.push_back({p[j], p[k], p[i], a});
            }
    energies_.resize(candidates_.size());
    energy_.of(complex_, candidates_, energies_.data());
    // cost[i][j]: cheapest triangulation of p[i..j], with its edge i-j closing it
    fan.cost.assign(static_cast<std::size_t>(n) * n, 0.0);
    fan.choice.assign(static_cast<std::size_t>(n) * n, -1);
    const auto pair_cost = [&](int i, int k, int j) {
        // rank of (i, k, j) in the order above
        const auto choose2 = [](int m) { return m * (m - 1) / 2; };
        const auto choose3 = [](int m) { return m * (m - 1) * (m - 2) / 6; };
        const int rank = choose3(n) - choose3(n - i) + choose2(n - i - 1) - choose2(n - k) + (j - k - 1);
        return energies_[2 * rank] + energies_[2 * rank + 1];
    };
    for (int length = 2; length < n; ++length)
        for (int i = 0; i + length < n; ++i) {
            const int j = i + length;
            double best = kInfinity;
            for (int k = i + 1; k < j; ++k) {
                const double cost = fan.cost[i * n + k] + fan.cost[k * n + j] + pair_cost(i, k, j);
                if (cost < best) {
                    best = cost;
                    fan.choice[i * n + j] = k;
                }
            }
            fan.cost[i * n + j] = best;
        }
    return fan.cost[n - 1] < kInfinity;
}

void Operators::carry_out(const Fan &fan, int a, int b) {
    const int n = static_cast<int>(fan.polygon.size());
    const std::vector<int> &p = fan.polygon;
    const int region = complex_.region(fan.tets[0]);
    for (int t : fan.tets)
        complex_.remove_tet(t);
    Edge stack[2 * kLargestRing];
    int top = 0;
    stack[top++] = {0, n - 1};
    while (top) {
        const auto [i, j] = stack[--top];
        if (j - i < 2)
            continue;
        const int k = fan.choice[i * n + j];
        const Tet two[2] = {{p[i], p[k], p[j], b}, {p[j], p[k], p[i], a}};
        double energies[2];
        energy_.of(complex_, two, energies);
        complex_.add_tet(two[0], region, energies[0]);
        complex_.add_tet(two[1], region, energies[1]);
        stack[top++] = {i, k};
        stack[top++] = {k, j};
    }
    for (int v : p)
        touch(v);
}

bool Operators::flips_surface(int a, int b, int r, int s, int patch) const {
    for (int t : complex_.star(r))
        if (complex_.has(t, s))
            return false; // r and s are joined already: the surface would pinch
    const Vec3 &pa = complex_.point(a), &pb = complex_.point(b), &pr = complex_.point(r), &ps = complex_.point(s);
    const Vec3 first = cross(pr - pa, ps - pa);
    const Vec3 second = cross(ps - pb, pr - pb);
    if (dot(first, second) < 0.8 * norm(first) * norm(second))
        return false;
    return guide_.allows(patch, pa, pr, ps) && guide_.allows(patch, pb, pr, ps);
}

bool Operators::remove_edge(int a, int b, double slack) {
    if (complex_.curve_of(a, b) >= 0 || !ring(a, b, ring_))
        return false;
    const int n = static_cast<int>(ring_.link.size());
    if (n < 3 || n > 2 * kLargestRing)
        return false;
    int patch = -1;
    int second = -1; // where the other surface facet stands in a closed ring
    int facets = 0;
    if (complex_.vertex(a).stratum != Stratum::interior && complex_.vertex(b).stratum != Stratum::interior)
        for (int k = 0; k < n; ++k) {
            const int here = complex_.patch_of(a, b, ring_.link[k]);
            if (here < 0)
                continue;
            if (facets++ == 0)
                patch = here;
            else if (here != patch)
                return false;
            second = k;
        }
    if (facets != 0 && (facets != 2 || !flip_surface))
        return false;
    if (!ring_.closed && facets != 2)
        return false;
    int fans = 1;
    if (ring_.closed && facets == 2) { // an interface: both of its sides are fans between the same two facets
        fans = 2;
        fans_[0].polygon.assign(ring_.link.begin(), ring_.link.begin() + second + 1);
        fans_[0].tets.assign(ring_.tets.begin(), ring_.tets.begin() + second);
        fans_[1].polygon.assign(ring_.link.begin() + second, ring_.link.end());
        fans_[1].polygon.push_back(ring_.link[0]);
        fans_[1].tets.assign(ring_.tets.begin() + second, ring_.tets.end());
    } else {
        fans_[0].polygon = ring_.link;
        fans_[0].tets = ring_.tets;
    }
    const int r = fans_[0].polygon.front();
    const int s = fans_[0].polygon.back();
    double before = 0.0;
    for (int t : ring_.tets)
        before += complex_.energy(t);
    double after = 0.0;
    for (int f = 0; f < fans; ++f) {
        const std::size_t size = fans_[f].polygon.size();
        if (size < 3 || size > kLargestRing)
            return false;
    }
    for (int f = 0; f < fans; ++f) {
        if (!plan(fans_[f], a, b))
            return false;
        after += fans_[f].cost[fans_[f].polygon.size() - 1];
        if (!(after < before + slack))
            return false;
    }
    if (facets == 2 && !flips_surface(a, b, r, s, patch))
        return false;
    for (int f = 0; f < fans; ++f)
        carry_out(fans_[f], a, b);
    if (facets == 2) {
        complex_.remove_facet(sorted(a, b, r));
        complex_.remove_facet(sorted(a, b, s));
        complex_.add_facet(sorted(a, r, s), patch);
        complex_.add_facet(sorted(b, r, s), patch);
    }
    touch(a);
    touch(b);
    return true;
}

bool Operators::flip_23(int t, int i, double slack) {
    const Tet tet = complex_.tet(t);
    const int b = tet[i];
    const int x = tet[kFacets[i][0]], y = tet[kFacets[i][1]], z = tet[kFacets[i][2]]; // winds towards b
    if (complex_.patch_of(x, y, z) >= 0)
        return false;
    const int s = complex_.across(t, x, y, z);
    if (s < 0)
        return false;
    int a = -1;
    for (int v : complex_.tet(s))
        if (v != x && v != y && v != z)
            a = v;
    const Tet three[3] = {{a, b, x, y}, {a, b, y, z}, {a, b, z, x}};
    double energies[3];
    energy_.of(complex_, three, energies);
    if (!(energies[0] + energies[1] + energies[2] < complex_.energy(t) + complex_.energy(s) + slack))
        return false;
    const int region = complex_.region(t);
    complex_.remove_tet(t);
    complex_.remove_tet(s);
    for (int k = 0; k < 3; ++k)
        complex_.add_tet(three[k], region, energies[k]);
    for (int v : {a, b, x, y, z})
        touch(v);
    return true;
}

bool Operators::collapse_links(int a, int b, const Ring &ring) const {
    // Link condition (Dey, Edelsbrunner, Guha, Nekhayev 1999), in the volume and on the surface: a and b share no
    // neighbour but round their edge.
    std::vector<int> shared;
    const auto neighbours = [&](int v) {
        std::vector<int> out;
        for (int t : complex_.star(v))
            for (int w : complex_.tet(t))
                if (w != a && w != b)
                    out.push_back(w);
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
        return out;
    };
    const std::vector<int> of_a = neighbours(a);
    const std::vector<int> of_b = neighbours(b);
    std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(shared));
    if (shared.size() != ring.link.size())
        return false;
    std::vector<Facet> facets;
    std::vector<int> patches;
    const auto surface_neighbours = [&](int v) {
        std::vector<int> out;
        surface_at(v, facets, patches);
        for (const Facet &facet : facets)
            for (int w : facet)
                if (w != a && w != b)
                    out.push_back(w);
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
        return out;
    };
    const std::vector<int> on_a = surface_neighbours(a);
    const std::vector<int> on_b = surface_neighbours(b);
    shared.clear();
    std::set_intersection(on_a.begin(), on_a.end(), on_b.begin(), on_b.end(), std::back_inserter(shared));
    std::size_t at_edge = 0;
    for (int v : ring.link)
        at_edge += complex_.patch_of(a, b, v) >= 0;
    return shared.size() == at_edge;
}

bool Operators::collapse(int a, int b, double slack) {
    const Vertex &gone = complex_.vertex(a);
    if (gone.stratum == Stratum::corner)
        return false;
    std::vector<Facet> facets;
    std::vector<int> patches;
    if (gone.stratum != Stratum::interior) {
        if (gone.stratum == Stratum::crease && complex_.curve_of(a, b) != gone.label)
            return false;
        if (complex_.vertex(b).stratum < gone.stratum || !ring(a, b, ring_))
            return false;
        const bool along =
            std::any_of(ring_.link.begin(), ring_.link.end(), [&](int v) { return complex_.patch_of(a, b, v) >= 0; });
        if (!along || !collapse_links(a, b, ring_))
            return false;
        surface_at(a, facets, patches);
    }
    const std::vector<int> old = complex_.star(a);
    double before = 0.0;
    candidates_.clear();
    regions_.clear();
    const double reach = longest * complex_.vertex(b).size;
    for (int t : old) {
        before += complex_.energy(t);
        if (complex_.has(t, b))
            continue;
        Tet tet = complex_.tet(t);
        for (int &v : tet) {
            if (v == a)
                v = b;
            else if (norm(complex_.point(v) - complex_.point(b)) > reach)
                return false;
        }
        candidates_.push_back(tet);
        regions_.push_back(complex_.region(t));
    }
    if (candidates_.empty())
        return false;
    energies_.resize(candidates_.size());
    energy_.of(complex_, candidates_, energies_.data());
    double after = 0.0;
    for (double e : energies_)
        after += e;
    if (!(after < before + slack))
        return false;
    for (std::size_t k = 0; k < facets.size(); ++k) {
        Facet facet = facets[k];
        if (facet[0] == b || facet[1] == b || facet[2] == b)
            continue;
        const Vec3 was = cross(complex_.point(facet[1]) - complex_.point(facet[0]),
                               complex_.point(facet[2]) - complex_.point(facet[0]));
        std::replace(facet.begin(), facet.end(), a, b);
        const Vec3 &p = complex_.point(facet[0]), &q = complex_.point(facet[1]), &r = complex_.point(facet[2]);
        const Vec3 is = cross(q - p, r - p);
        if (dot(was, is) < 0.8 * norm(was) * norm(is) || !guide_.allows(patches[k], p, q, r))
            return false;
    }
    Edge joined{-1, -1};
    if (gone.stratum == Stratum::crease) { // its two crease edges a-b and a-w become b-w
        for (int t : old)
            for (int v : complex_.tet(t))
                if (v != a && v != b && complex_.curve_of(a, v) >= 0)
                    joined = sorted(b, v);
        if (joined[0] < 0 || complex_.curve_of(joined[0], joined[1]) >= 0 ||
            !guide_.allows_crease(gone.label, complex_.point(joined[0]), complex_.point(joined[1])))
            return false;
    }
    const int curve = gone.label;
    for (int t : old)
        complex_.remove_tet(t);
    for (std::size_t k = 0; k < candidates_.size(); ++k)
        complex_.add_tet(candidates_[k], regions_[k], energies_[k]);
    for (std::size_t k = 0; k < facets.size(); ++k) {
        Facet facet = facets[k];
        complex_.remove_facet(facet);
        if (facet[0] == b || facet[1] == b || facet[2] == b)
            continue;
        std::replace(facet.begin(), facet.end(), a, b);
        complex_.add_facet(sorted(facet[0], facet[1], facet[2]), patches[k]);
    }
    if (joined[0] >= 0) {
        complex_.remove_crease(sorted(a, b));
        complex_.remove_crease(sorted(a, joined[0] == b ? joined[1] : joined[0]));
        complex_.add_crease(joined, curve);
    }
    touch(b);
    for (const Tet &tet : candidates_)
        for (int v : tet)
            touch(v);
    return true;
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
    energies_.resize(candidates_.size());
    energy_.of(complex_, candidates_, energies_.data());
    double after = 0.0;
    for (double e : energies_)
        after += e;
    if (!(after < before + slack))
        return std::nullopt;
    for (std::size_t k = 0; k < facet_apices.size(); ++k) {
        const Vec3 &apex = complex_.point(facet_apices[k]);
        if (!guide_.allows(facet_patches[k], complex_.point(a), middle.position, apex) ||
            !guide_.allows(facet_patches[k], middle.position, complex_.point(b), apex))
            return std::nullopt;
    }
    for (int t : ring_.tets)
        complex_.remove_tet(t);
    for (std::size_t k = 0; k < candidates_.size(); ++k)
        complex_.add_tet(candidates_[k], regions_[k / 2], energies_[k]);
    for (std::size_t k = 0; k < facet_apices.size(); ++k) {
        complex_.remove_facet(sorted(a, b, facet_apices[k]));
        complex_.add_facet(sorted(a, v, facet_apices[k]), facet_patches[k]);
        complex_.add_facet(sorted(v, b, facet_apices[k]), facet_patches[k]);
    }
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
    energies_.resize(candidates_.size());
    energy_.of(complex_, candidates_, energies_.data());
    double after = 0.0;
    for (double e : energies_)
        after += e;
    if (!(after < before + slack))
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
