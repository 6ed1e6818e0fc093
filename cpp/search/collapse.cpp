// Taking a vertex away.

#include "base/sort_unique.h"
#include "search/operators.h"

#include <algorithm>
#include <iterator>

namespace wct::search {

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
        sort_unique(out);
        return out;
    };
    const std::vector<int> of_a = neighbours(a);
    const std::vector<int> of_b = neighbours(b);
    std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(shared));
    if (shared.size() != ring.link.size())
        return false;
    std::vector<TetComplex::SurfaceAt> facets;
    const auto surface_neighbours = [&](int v) {
        std::vector<int> out;
        complex_.surface_at(v, facets);
        for (const auto &at : facets)
            for (int w : at.key)
                if (w != a && w != b)
                    out.push_back(w);
        sort_unique(out);
        return out;
    };
    const std::vector<int> on_a = surface_neighbours(a);
    const std::vector<int> on_b = surface_neighbours(b);
    shared.clear();
    std::set_intersection(on_a.begin(), on_a.end(), on_b.begin(), on_b.end(), std::back_inserter(shared));
    std::size_t at_edge = 0;
    for (int v : ring.link)
        at_edge += complex_.is_surface(a, b, v);
    return shared.size() == at_edge;
}

bool Operators::collapses_along_surface(int a, int b) {
    const Vertex &gone = complex_.vertex(a);
    if (gone.stratum == Stratum::crease && complex_.curve_of(a, b) != gone.label)
        return false;
    if (complex_.vertex(b).stratum < gone.stratum || !ring(a, b, ring_))
        return false;
    const bool along =
        std::any_of(ring_.link.begin(), ring_.link.end(), [&](int v) { return complex_.is_surface(a, b, v); });
    return along && collapse_links(a, b, ring_);
}

bool Operators::pull_tets(int a, int b) {
    candidates_.clear();
    regions_.clear();
    const double reach = longest * complex_.vertex(b).size;
    for (int t : complex_.star(a)) {
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
    return !candidates_.empty();
}

bool Operators::pull_facets(int a, int b) {
    constexpr double turn = 0.8; // cosine of the angle by which a facet may turn
    complex_.surface_at(a, facets_);
    for (const auto &at : facets_) {
        Facet facet = at.key;
        watch_.goes(facet);
        if (facet[0] == b || facet[1] == b || facet[2] == b)
            continue;
        const Vec3 was = normal_of(complex_.corners(facet));
        std::replace(facet.begin(), facet.end(), a, b);
        const Vec3 is = normal_of(complex_.corners(facet));
        if (dot(was, is) < turn * norm(was) * norm(is))
            return false;
        if (complex_.is_surface(facet[0], facet[1], facet[2]))
            return false; // two sheets would become one
        watch_.comes(sorted(facet), at.facet->patch);
    }
    return true;
}

std::optional<Edge> Operators::join_creases(int a, int b) const {
    std::optional<Edge> joined;
    for (int t : complex_.star(a))
        for (int v : complex_.tet(t))
            if (v != a && v != b && complex_.is_crease(a, v)) {
                if (joined && *joined != sorted(b, v))
                    return std::nullopt; // other creases meet at a: their edges would be left without it
                joined = sorted(b, v);
            }
    if (!joined || complex_.is_crease((*joined)[0], (*joined)[1]) ||
        !guide_.allows_crease(complex_.vertex(a).label, complex_.point((*joined)[0]), complex_.point((*joined)[1])))
        return std::nullopt;
    return joined;
}

bool Operators::collapse(int a, int b, double slack) {
    const Stratum stratum = complex_.vertex(a).stratum;
    const int curve = complex_.vertex(a).label;
    if (stratum == Stratum::corner || (stratum != Stratum::interior && !collapses_along_surface(a, b)))
        return false;
    const std::vector<int> old = complex_.star(a);
    if (!pull_tets(a, b) || !candidates_below(sum_of(old) + slack) || !candidates_fit(old))
        return false;
    if (stratum == Stratum::interior && (!ring(a, b, ring_) || !collapse_links(a, b, ring_)))
        return false; // only where the mesh overlaps itself can this be, with all tets positive
    watch_.clear();
    if (!pull_facets(a, b) || !watch_.allows_replacing())
        return false;
    std::optional<Edge> joined;
    if (stratum == Stratum::crease && !(joined = join_creases(a, b)))
        return false;
    if (watch_.replace())
        energy_.of(complex_, candidates_, energies_.data());
    replace_tets(old);
    if (joined) {
        complex_.remove_crease(sorted(a, b));
        complex_.remove_crease(sorted(a, (*joined)[0] == b ? (*joined)[1] : (*joined)[0]));
        complex_.add_crease(*joined, curve);
    }
    WCT_CHECK(complex_.checks.did("collapse");)
    touch(b);
    touch_candidates();
    return true;
}

} // namespace wct::search
