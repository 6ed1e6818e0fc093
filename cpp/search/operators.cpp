#include "search/operators.h"

#include "base/sort_unique.h"

#include <algorithm>

namespace wct::search {

namespace {

/// Corners k, l such that (i, j, k, l) is an even permutation.
constexpr int kRest[4][4][2] = {{{}, {2, 3}, {3, 1}, {1, 2}},
                                {{3, 2}, {}, {0, 3}, {2, 0}},
                                {{1, 3}, {3, 0}, {}, {0, 1}},
                                {{2, 1}, {0, 2}, {1, 0}, {}}};

int corner_of(const Tet &tet, int v) {
    int i = 0;
    while (tet[i] != v)
        ++i;
    return i;
}

/// Of a tet with edge a-b the other two vertices, p and q, where (a, b, p, q) is positive.
Edge opposite(const Tet &tet, int a, int b) {
    const int *rest = kRest[corner_of(tet, a)][corner_of(tet, b)];
    return {tet[rest[0]], tet[rest[1]]};
}

} // namespace

void Operators::touch(int v) {
    if (std::find(touched.begin(), touched.end(), v) == touched.end())
        touched.push_back(v);
}

bool Operators::ring(int a, int b, Ring &ring) const {
    ring.link.clear();
    ring.tets.clear();
    ring.opposite.clear();
    ring.closed = true;
    constexpr int most = 64; // tets at an edge; one with more is left alone
    int from[most];
    int to[most];
    int tets[most];
    int count = 0;
    for (int t : complex_.star(a)) {
        if (!complex_.has(t, b))
            continue;
        if (count == most)
            return false;
        const auto [p, q] = opposite(complex_.tet(t), a, b);
        from[count] = p;
        to[count] = q;
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
            if (complex_.is_surface(a, b, from[k])) {
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
        ring.opposite.push_back({current, to[found - from]});
        current = to[found - from];
        if (k + 1 < count || !ring.closed)
            ring.link.push_back(current);
        if (current == start && k + 1 < count)
            return false;
    }
    return !ring.closed || current == start;
}

bool Operators::fans(int a, int b, Ring &ring) const {
    if (this->ring(a, b, ring))
        return true;
    ring.link.clear();
    ring.tets.clear();
    ring.opposite.clear();
    ring.closed = false;
    for (int t : complex_.star(a)) {
        if (!complex_.has(t, b))
            continue;
        const Edge others = opposite(complex_.tet(t), a, b);
        ring.tets.push_back(t);
        ring.opposite.push_back(others);
        ring.link.insert(ring.link.end(), others.begin(), others.end());
    }
    sort_unique(ring.link);
    return !ring.tets.empty();
}

double Operators::sum_of(const std::vector<int> &tets) const {
    double sum = 0.0;
    for (int t : tets)
        sum += complex_.energy(t);
    return sum;
}

void Operators::replace_tets(const std::vector<int> &gone) {
    for (int t : gone)
        complex_.remove_tet(t);
    for (std::size_t k = 0; k < candidates_.size(); ++k)
        complex_.add_tet(candidates_[k], regions_[k], energies_[k]);
}

void Operators::touch_candidates() {
    for (const Tet &tet : candidates_)
        for (int v : tet)
            touch(v);
}

bool Operators::candidates_below(double limit) {
    energies_.resize(candidates_.size());
    return energy_.below(complex_, candidates_, limit, energies_.data());
}

bool Operators::candidates_fit(const std::vector<int> &gone) const {
    std::vector<Facet> facets;
    for (const Tet &tet : candidates_)
        for (const auto &f : kFacets)
            facets.push_back(sorted(tet[f[0]], tet[f[1]], tet[f[2]]));
    std::sort(facets.begin(), facets.end());
    for (std::size_t k = 0, end = 0; k < facets.size(); k = end) {
        const auto &[a, b, c] = facets[k];
        for (end = k + 1; end < facets.size() && facets[end] == facets[k];)
            ++end;
        const std::vector<int> &star = complex_.star(a);
        const auto staying = std::count_if(star.begin(), star.end(), [&](int t) {
            return complex_.has(t, b) && complex_.has(t, c) && std::find(gone.begin(), gone.end(), t) == gone.end();
        });
        if (static_cast<std::size_t>(staying) + (end - k) > 2)
            return false;
    }
    return true;
}

} // namespace wct::search
