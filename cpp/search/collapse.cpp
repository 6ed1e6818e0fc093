// Taking a vertex away.

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
        std::sort(out.begin(), out.end());
        out.erase(std::unique(out.begin(), out.end()), out.end());
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
    std::vector<TetComplex::SurfaceAt> facets;
    if (gone.stratum != Stratum::interior) {
        if (gone.stratum == Stratum::crease && complex_.curve_of(a, b) != gone.label)
            return false;
        if (complex_.vertex(b).stratum < gone.stratum || !ring(a, b, ring_))
            return false;
        const bool along =
            std::any_of(ring_.link.begin(), ring_.link.end(), [&](int v) { return complex_.patch_of(a, b, v) >= 0; });
        if (!along || !collapse_links(a, b, ring_))
            return false;
        complex_.surface_at(a, facets);
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
    if (!candidates_below(before + slack) || !candidates_fit(old))
        return false;
    if (gone.stratum == Stratum::interior && (!ring(a, b, ring_) || !collapse_links(a, b, ring_)))
        return false; // only where the mesh overlaps itself can this be, with all tets positive
    watch_.clear();
    for (const auto &at : facets) {
        Facet facet = at.key;
        watch_.goes(facet);
        if (facet[0] == b || facet[1] == b || facet[2] == b)
            continue;
        const Vec3 was = cross(complex_.point(facet[1]) - complex_.point(facet[0]),
                               complex_.point(facet[2]) - complex_.point(facet[0]));
        std::replace(facet.begin(), facet.end(), a, b);
        const Vec3 &p = complex_.point(facet[0]), &q = complex_.point(facet[1]), &r = complex_.point(facet[2]);
        const Vec3 is = cross(q - p, r - p);
        if (dot(was, is) < 0.8 * norm(was) * norm(is))
            return false;
        if (complex_.patch_of(facet[0], facet[1], facet[2]) >= 0)
            return false; // two sheets would become one
        watch_.comes(sorted(facet[0], facet[1], facet[2]), at.facet->patch);
    }
    if (!watch_.allows_replacing())
        return false;
    Edge joined{-1, -1};
    if (gone.stratum == Stratum::crease) { // its two crease edges a-b and a-w become b-w
        for (int t : old)
            for (int v : complex_.tet(t))
                if (v != a && v != b && complex_.curve_of(a, v) >= 0) {
                    if (joined[0] >= 0 && joined != sorted(b, v))
                        return false; // other creases meet at a: their edges would be left without it
                    joined = sorted(b, v);
                }
        if (joined[0] < 0 || complex_.curve_of(joined[0], joined[1]) >= 0 ||
            !guide_.allows_crease(gone.label, complex_.point(joined[0]), complex_.point(joined[1])))
            return false;
    }
    const int curve = gone.label;
    if (watch_.replace())
        energy_.of(complex_, candidates_, energies_.data());
    for (int t : old)
        complex_.remove_tet(t);
    for (std::size_t k = 0; k < candidates_.size(); ++k)
        complex_.add_tet(candidates_[k], regions_[k], energies_[k]);
    if (joined[0] >= 0) {
        complex_.remove_crease(sorted(a, b));
        complex_.remove_crease(sorted(a, joined[0] == b ? joined[1] : joined[0]));
        complex_.add_crease(joined, curve);
    }
    WCT_CHECK(complex_.checks.did("collapse");)
    touch(b);
    for (const Tet &tet : candidates_)
        for (int v : tet)
            touch(v);
    return true;
}

} // namespace wct::search
