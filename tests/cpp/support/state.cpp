#include "support/state.h"

#include "geometry/predicates.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

namespace wct::tests {

using search::TetComplex;

std::vector<int> living(const TetComplex &complex) {
    std::vector<int> tets;
    for (std::size_t k = 0; k < complex.tet_slots(); ++k)
        if (complex.alive(static_cast<int>(k)))
            tets.push_back(static_cast<int>(k));
    return tets;
}

namespace {

std::string named(const char *what, const Facet &f) {
    std::ostringstream out;
    out << what << " (" << f[0] << ", " << f[1] << ", " << f[2] << ")";
    return out.str();
}

std::string named(const char *what, int number) {
    return std::string(what) + " " + std::to_string(number);
}

std::string tets_fault(const TetComplex &complex) {
    std::vector<std::vector<int>> stars(complex.vertex_slots());
    double total = 0.0;
    const std::vector<int> tets = living(complex);
    if (tets.size() != complex.tets())
        return "the count of tets is wrong";
    for (const int t : tets) {
        const Tet &tet = complex.tet(t);
        if (geometry::orient3d(complex.point(tet[0]), complex.point(tet[1]), complex.point(tet[2]),
                               complex.point(tet[3])) != 1)
            return named("not positive: tet", t);
        for (const int v : tet)
            stars[v].push_back(t);
        total += complex.energy(t);
    }
    if (!(std::abs(total - complex.total()) <= 1e-9 * (1.0 + std::abs(total))))
        return "the energies' sum is wrong";
    for (std::size_t v = 0; v < stars.size(); ++v) {
        std::vector<int> star = complex.star(static_cast<int>(v));
        std::sort(star.begin(), star.end());
        if (star != stars[v])
            return named("not all its tets, or others, are in the star of vertex", static_cast<int>(v));
    }
    return "";
}

/// Tets at a facet, and whether each winds along its ascending corners when seen from inside.
using Uses = std::map<Facet, std::vector<std::pair<int, bool>>>;

Uses uses_of(const TetComplex &complex) {
    Uses uses;
    for (const int t : living(complex))
        for (const auto &f : kFacets) {
            Facet key{complex.tet(t)[f[0]], complex.tet(t)[f[1]], complex.tet(t)[f[2]]};
            const bool even = ascend(key);
            uses[key].push_back({t, even});
        }
    return uses;
}

std::string facets_fault(const TetComplex &complex, const Uses &uses) {
    for (const auto &[key, both] : uses) {
        const int patch = complex.patch_of(key[0], key[1], key[2]);
        if (both.size() > 2)
            return named("more than two tets at facet", key);
        if (both.size() == 2 && both[0].second == both[1].second)
            return named("two tets on one side of facet", key);
        const bool border = both.size() == 1 || complex.region(both[0].first) != complex.region(both[1].first);
        if (border && patch < 0)
            return named("not in the surface map: facet", key);
    }
    for (const auto &[key, patch] : complex.sorted_surface())
        if (!uses.contains(key))
            return named("of no tet: surface facet", key);
    return "";
}

std::string creases_fault(const TetComplex &complex, const Uses &uses) {
    std::set<Edge> edges;
    for (const auto &[key, tets] : uses)
        for (int i = 0; i < 3; ++i)
            edges.insert(sorted(key[i], key[(i + 1) % 3]));
    for (const auto &[edge, curve] : complex.creases())
        if (!edges.contains(edge))
            return named("of no tet: crease", {edge[0], edge[1], -1});
    std::map<Edge, std::set<int>> patches;
    for (const auto &[key, patch] : complex.sorted_surface())
        for (int i = 0; i < 3; ++i)
            patches[sorted(key[i], key[(i + 1) % 3])].insert(patch);
    for (const auto &[edge, here] : patches)
        if (here.size() > 1 && complex.curve_of(edge[0], edge[1]) < 0)
            return named("patches meet where no crease is: edge", {edge[0], edge[1], -1});
    return "";
}

std::string landmarks_fault(const State &state) {
    int over = 0;
    std::set<int> seen;
    for (const State::OfFacet &facet : state.facets) {
        over += facet.over > 0.0;
        for (const int l : facet.landmarks)
            if (!seen.insert(l).second)
                return named("of two facets: landmark", l);
    }
    return over == state.over_count ? "" : "the count of facets beyond the tolerance is wrong";
}

} // namespace

State::State(const TetComplex &complex)
    : count(complex.tets()), slots(complex.tet_slots()), total(complex.total()), over_count(complex.over_count()) {
    for (std::size_t k = 0; k < complex.vertex_slots(); ++k) {
        const search::Vertex &v = complex.vertex(static_cast<int>(k));
        vertices.push_back(
            {v.position, v.stratum, v.label, v.size, v.needle, v.hint, complex.star(static_cast<int>(k))});
    }
    for (const int t : living(complex))
        tets.push_back({t, complex.region(t), complex.tet(t), complex.energy(t)});
    for (const auto &[key, patch] : complex.sorted_surface()) {
        std::vector<int> landmarks;
        for (int l = complex.facet(key).landmark; l >= 0; l = complex.next_landmark(l))
            landmarks.push_back(l);
        facets.push_back({key, patch, complex.over(key), complex.facet(key).hints, std::move(landmarks)});
    }
    creases.assign(complex.creases().begin(), complex.creases().end());
    std::sort(creases.begin(), creases.end());
}

Content::Content(const TetComplex &complex) {
    const auto placed = [&](const auto &cell, std::vector<double> known) {
        std::vector<std::array<double, 3>> corners;
        for (const int v : cell)
            corners.push_back({complex.point(v).x, complex.point(v).y, complex.point(v).z});
        std::sort(corners.begin(), corners.end());
        std::vector<double> out;
        for (const auto &corner : corners)
            out.insert(out.end(), corner.begin(), corner.end());
        out.insert(out.end(), known.begin(), known.end());
        return out;
    };
    for (const int t : living(complex))
        tets.push_back(placed(complex.tet(t), {static_cast<double>(complex.region(t)), complex.energy(t)}));
    for (const State::OfFacet &facet : State(complex).facets) {
        std::vector<double> known{static_cast<double>(facet.patch), facet.over};
        known.insert(known.end(), facet.hints.begin(), facet.hints.end());
        std::vector<double> landmarks(facet.landmarks.begin(), facet.landmarks.end());
        std::sort(landmarks.begin(), landmarks.end());
        known.insert(known.end(), landmarks.begin(), landmarks.end());
        facets.push_back(placed(facet.key, known));
    }
    for (const auto &[edge, curve] : complex.creases())
        creases.push_back(placed(edge, {static_cast<double>(curve)}));
    for (auto *cells : {&tets, &facets, &creases})
        std::sort(cells->begin(), cells->end());
}

std::string difference(const State &before, const State &after) {
    if (before.vertices != after.vertices)
        return "vertices or their stars";
    if (before.tets != after.tets)
        return "tets, their regions or energies";
    if (before.facets != after.facets)
        return "surface facets, how far over they are, or their landmarks";
    if (before.creases != after.creases)
        return "creases";
    if (before.total != after.total)
        return "the total energy";
    return before == after ? "" : "counts";
}

std::string fault(const TetComplex &complex) {
    std::string found = tets_fault(complex);
    const Uses uses = found.empty() ? uses_of(complex) : Uses{};
    if (found.empty())
        found = facets_fault(complex, uses);
    if (found.empty())
        found = creases_fault(complex, uses);
    if (found.empty())
        found = landmarks_fault(State(complex));
    return found;
}

std::vector<int> characteristics(const TetComplex &complex) {
    std::map<int, std::set<std::vector<int>>> cells; // by region: all faces, ascending
    for (const int t : living(complex)) {
        Tet tet = complex.tet(t);
        std::sort(tet.begin(), tet.end());
        for (int bits = 1; bits < 16; ++bits) {
            std::vector<int> face;
            for (int i = 0; i < 4; ++i)
                if (bits >> i & 1)
                    face.push_back(tet[i]);
            cells[complex.region(t)].insert(std::move(face));
        }
    }
    std::vector<int> sums;
    for (const auto &[region, faces] : cells) {
        int sum = 0;
        for (const auto &face : faces)
            sum += face.size() % 2 ? 1 : -1;
        sums.push_back(sum);
    }
    return sums;
}

std::string pinch(const TetComplex &complex) {
    std::map<std::pair<int, Edge>, int> facets; // of a region's boundary
    for (const auto &[key, both] : uses_of(complex)) {
        if (both.size() == 2 && complex.region(both[0].first) == complex.region(both[1].first))
            continue;
        for (const auto &[t, even] : both)
            for (int i = 0; i < 3; ++i)
                ++facets[{complex.region(t), sorted(key[i], key[(i + 1) % 3])}];
    }
    for (const auto &[at, count] : facets)
        if (count != 2)
            return named("the surface pinches: edge", {at.second[0], at.second[1], -1});
    return "";
}

std::vector<double> volumes(const TetComplex &complex) {
    std::vector<double> sums;
    for (const int t : living(complex)) {
        const Tet &tet = complex.tet(t);
        const Vec3 &o = complex.point(tet[0]);
        sums.resize(std::max<std::size_t>(sums.size(), static_cast<std::size_t>(complex.region(t)) + 1), 0.0);
        sums[complex.region(t)] +=
            dot(complex.point(tet[1]) - o, cross(complex.point(tet[2]) - o, complex.point(tet[3]) - o)) / 6.0;
    }
    return sums;
}

} // namespace wct::tests
