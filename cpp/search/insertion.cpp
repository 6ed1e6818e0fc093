// Adding a vertex in the middle of a cavity, inside or on the surface.

#include "base/sort_unique.h"
#include "search/operators.h"

#include "geometry/circumspheres.h"

#include <algorithm>

namespace wct::search {

namespace {

/// Whether x lies in the smallest sphere through a facet's corners.
bool in_facet_sphere(const std::array<Vec3, 3> &f, const Vec3 &x) {
    const Vec3 u = f[1] - f[0], v = f[2] - f[0], n = cross(u, v);
    const Vec3 r = geometry::to_circumcenter(u, v, n);
    const Vec3 d = x - f[0] - r;
    return dot(d, d) < dot(r, r);
}

} // namespace

bool Operators::in_circumsphere(int t, const Vec3 &x) const {
    const Tet &tet = complex_.tet(t);
    const Vec3 &o = complex_.point(tet[0]);
    const Vec3 u = complex_.point(tet[1]) - o, v = complex_.point(tet[2]) - o, w = complex_.point(tet[3]) - o;
    const double det = dot(u, cross(v, w));
    const Vec3 r = geometry::to_circumcenter(u, v, w, det);
    const Vec3 d = x - o - r;
    return dot(d, d) < dot(r, r);
}

bool Operators::grow_cavity(const Vec3 &x, const std::vector<Facet> &open) {
    constexpr std::size_t largest = 60;
    const std::size_t kept = cavity_.size();
    for (std::size_t k = 0; k < cavity_.size(); ++k) {
        const Tet tet = complex_.tet(cavity_[k]);
        for (int i = 0; i < 4; ++i) {
            const auto [p, q, r] = inward_facet(tet, i);
            const int s = complex_.is_surface(p, q, r) ? -1 : complex_.across(cavity_[k], p, q, r);
            if (s < 0 || in_cavity(s) || !in_circumsphere(s, x))
                continue;
            cavity_.push_back(s);
            if (cavity_.size() > largest)
                return false;
        }
    }
    return carve_cavity(x, open, kept);
}

bool Operators::carve_cavity(const Vec3 &x, const std::vector<Facet> &open, std::size_t kept) {
    const auto hidden = [&](int t) {
        const Tet &tet = complex_.tet(t);
        for (int i = 0; i < 4; ++i) {
            const auto [p, q, r] = inward_facet(tet, i);
            const Vec3 &o = complex_.point(p);
            const Vec3 normal = cross(complex_.point(q) - o, complex_.point(r) - o);
            if (dot(normal, complex_.point(tet[i]) - o) * dot(normal, x - o) > 0.0)
                continue;
            const bool surface = complex_.is_surface(p, q, r);
            if (surface && std::find(open.begin(), open.end(), sorted(p, q, r)) != open.end())
                continue;
            const int s = surface ? -1 : complex_.across(t, p, q, r);
            if (s < 0 || !in_cavity(s))
                return true;
        }
        return false;
    };
    for (bool again = true; again;) {
        again = false;
        for (std::size_t k = cavity_.size(); k-- > 0;)
            if (hidden(cavity_[k])) {
                if (k < kept)
                    return false;
                cavity_.erase(cavity_.begin() + static_cast<std::ptrdiff_t>(k));
                again = true;
            }
    }
    return true;
}

bool Operators::cone_cavity(int v, const std::vector<Facet> &open, double slack) {
    const Vec3 x = complex_.point(v);
    candidates_.clear();
    regions_.clear();
    double before = 0.0;
    std::vector<int> inside;
    std::vector<Facet> wall;
    std::vector<Edge> creases;
    for (int t : cavity_) {
        before += complex_.energy(t);
        const Tet tet = complex_.tet(t);
        inside.insert(inside.end(), tet.begin(), tet.end());
        for (int i = 0; i < 4; ++i)
            for (int k = 0; k < i; ++k)
                if (complex_.is_crease(tet[i], tet[k]))
                    creases.push_back({tet[i], tet[k]});
        for (int i = 0; i < 4; ++i) {
            const auto [p, q, r] = inward_facet(tet, i);
            const Facet key = sorted(p, q, r);
            if (complex_.is_surface(p, q, r)) {
                if (std::find(open.begin(), open.end(), key) != open.end())
                    continue;
            } else if (const int s = complex_.across(t, p, q, r); s >= 0 && in_cavity(s)) {
                continue;
            }
            Tet coned = tet;
            coned[i] = v;
            candidates_.push_back(coned);
            regions_.push_back(complex_.region(t));
            wall.push_back(key);
            for (int w : key)
                if (norm(complex_.point(w) - x) < shortest * complex_.vertex(v).size)
                    return false;
        }
    }
    const auto on_wall = [&](int w) {
        return std::any_of(wall.begin(), wall.end(),
                           [&](const Facet &f) { return std::find(f.begin(), f.end(), w) != f.end(); });
    };
    if (!std::all_of(inside.begin(), inside.end(), on_wall))
        return false; // a vertex would be left without a tet
    // Round the free border of a sheet, and round a wire, nothing of the surface stops a cavity: it may hold all tets
    // at an edge of them, which would be no edge any more.
    for (const Edge &edge : creases)
        if (std::none_of(wall.begin(), wall.end(), [&](const Facet &f) {
                return std::find(f.begin(), f.end(), edge[0]) != f.end() &&
                       std::find(f.begin(), f.end(), edge[1]) != f.end();
            }))
            return false;
    return has_room(cavity_.size(), candidates_.size()) && candidates_below(before + slack) && candidates_fit(cavity_);
}

bool Operators::cone_is_closed(int v, const std::vector<Edge> &rim) const {
    std::vector<Edge> edges; // of the walls: with v, each is a facet of the tets at its walls
    for (const Tet &tet : candidates_)
        for (int i = 0; i < 4; ++i)
            for (int k = 0; k < i; ++k)
                if (tet[i] != v && tet[k] != v)
                    edges.push_back(sorted(tet[i], tet[k]));
    std::sort(edges.begin(), edges.end());
    const auto walls = [&](const Edge &edge) {
        const auto [first, last] = std::equal_range(edges.begin(), edges.end(), edge);
        return last - first;
    };
    const auto on_rim = [&](const Edge &edge) { return std::find(rim.begin(), rim.end(), edge) != rim.end(); };
    return std::all_of(edges.begin(), edges.end(),
                       [&](const Edge &edge) { return walls(edge) == 2 || (walls(edge) == 1 && on_rim(edge)); }) &&
           std::all_of(rim.begin(), rim.end(), [&](const Edge &edge) { return walls(edge) > 0; });
}

void Operators::fill_cavity() {
    replace_tets(cavity_);
    touch_candidates();
}

std::optional<int> Operators::insert(int t0, const Vec3 &x, double slack) {
    cavity_.assign(1, t0);
    if (!grow_cavity(x, {}))
        return std::nullopt;
    Vertex vertex;
    vertex.position = x;
    for (int v : complex_.tet(t0))
        vertex.size += 0.25 * complex_.vertex(v).size;
    const int v = complex_.add_vertex(vertex);
    if (!cone_cavity(v, {}, slack) || !cone_is_closed(v, {}))
        return std::nullopt;
    fill_cavity();
    WCT_CHECK(complex_.checks.did("insert");)
    return v;
}

Vertex Operators::surface_vertex(const Facet &at, const Vec3 &near) const {
    Vertex vertex;
    vertex.position = near;
    vertex.stratum = Stratum::patch;
    vertex.label = complex_.patch_of(at[0], at[1], at[2]);
    vertex.hint = complex_.facet(sorted(at)).hints[0];
    for (int w : at)
        vertex.size += complex_.vertex(w).size / 3.0;
    guide_.admit(vertex, vertex.position);
    return vertex;
}

std::vector<Edge> Operators::grow_opening(const Vec3 &x, int patch, std::vector<Facet> &open) {
    std::vector<Edge> edges;
    for (std::size_t k = 0; k < open.size(); ++k)
        for (int i = 0; i < 3; ++i) {
            const Edge edge = sorted(open[k][i], open[k][(i + 1) % 3]);
            edges.push_back(edge);
            if (complex_.is_crease(edge[0], edge[1]))
                continue;
            complex_.surface_at(edge[0], facets_);
            for (const auto &[key, facet] : facets_)
                if (facet->patch == patch && std::find(key.begin(), key.end(), edge[1]) != key.end() &&
                    std::find(open.begin(), open.end(), key) == open.end() && in_facet_sphere(complex_.corners(key), x))
                    open.push_back(key);
        }
    std::sort(edges.begin(), edges.end());
    return edges;
}

bool Operators::find_rim(const std::vector<Edge> &edges, const std::vector<Facet> &open, std::vector<Edge> &rim) const {
    for (const Edge &edge : edges)
        if (std::count(edges.begin(), edges.end(), edge) == 1)
            rim.push_back(edge);
        else if (complex_.is_crease(edge[0], edge[1]))
            return false; // a crease within the patch, all of whose facets would go
    for (const Facet &f : open)
        for (int w : f)
            if (std::none_of(rim.begin(), rim.end(), [&](const Edge &e) { return e[0] == w || e[1] == w; }))
                return false; // w would leave the surface
    return true;
}

void Operators::start_cavity(const std::vector<Facet> &open) {
    cavity_.clear();
    for (const Facet &f : open)
        for (int t : complex_.star(f[0]))
            if (complex_.has(t, f[1]) && complex_.has(t, f[2]))
                cavity_.push_back(t);
    sort_unique(cavity_);
}

std::optional<int> Operators::insert_on_surface(const Facet &at, const Vec3 &near, double slack) {
    const int patch = complex_.patch_of(at[0], at[1], at[2]);
    if (!split_surface || patch < 0 || fixes(patch))
        return std::nullopt;
    const Vertex vertex = surface_vertex(at, near);
    const Vec3 x = vertex.position;
    std::vector<Facet> open{sorted(at)};
    std::vector<Edge> rim;
    if (!find_rim(grow_opening(x, patch, open), open, rim))
        return std::nullopt;
    start_cavity(open);
    if (!grow_cavity(x, open))
        return std::nullopt;
    const int v = complex_.add_vertex(vertex);
    if (!cone_cavity(v, open, slack) || !cone_is_closed(v, rim))
        return std::nullopt;
    watch_.clear();
    for (const Facet &f : open)
        watch_.goes(f);
    for (const Edge &e : rim)
        watch_.comes(sorted(e[0], e[1], v), patch);
    if (!watch_.allows_replacing())
        return std::nullopt;
    if (watch_.replace())
        energy_.of(complex_, candidates_, energies_.data());
    fill_cavity();
    WCT_CHECK(complex_.checks.did("insert_on_surface");)
    return v;
}

} // namespace wct::search
