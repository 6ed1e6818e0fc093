#include "library/surface_facets.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace wct::library {

namespace {

/// A facet as one of its tets has it.
struct HalfFacet {
    Facet key; // ascending
    int tet;
    int opposite; // the corner that is not in it
    bool even;    // whether the facet, outward, is an even permutation of its key
};

Facet outward(const Tet &tet, int i) {
    const auto &[a, b, c] = kFacets[i]; // winds towards the corner
    return {tet[a], tet[c], tet[b]};
}

std::string named(const Facet &facet) {
    return "facet (" + std::to_string(facet[0]) + ", " + std::to_string(facet[1]) + ", " + std::to_string(facet[2]) +
           ")";
}

/// By key, and of equal ones by tet.
std::vector<HalfFacet> half_facets(std::span<const Tet> tets) {
    std::vector<HalfFacet> halves;
    halves.reserve(4 * tets.size());
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (int i = 0; i < 4; ++i) {
            Facet key = outward(tets[t], i);
            const bool even = ascend(key);
            halves.push_back({key, static_cast<int>(t), i, even});
        }
    std::sort(halves.begin(), halves.end(),
              [](const HalfFacet &a, const HalfFacet &b) { return a.key != b.key ? a.key < b.key : a.tet < b.tet; });
    return halves;
}

} // namespace

SurfaceFacets surface_of(std::span<const Tet> tets, std::span<const int> region) {
    struct Found {
        int order;
        Facet triangle;
        std::array<int, 2> sides;
    };
    std::vector<Found> boundary, interfaces;
    const std::vector<HalfFacet> halves = half_facets(tets);
    for (std::size_t k = 0, next; k < halves.size(); k = next) {
        next = k + 1;
        while (next < halves.size() && halves[next].key == halves[k].key)
            ++next;
        const HalfFacet &one = halves[k], &other = halves[next - 1];
        if (next - k > 2)
            throw std::invalid_argument(named(one.key) + " belongs to tets " + std::to_string(one.tet) + ", " +
                                        std::to_string(halves[k + 1].tet) + " and " + std::to_string(other.tet) +
                                        "; at most two may share one");
        if (next - k == 2 && one.even == other.even)
            throw std::invalid_argument("tets " + std::to_string(one.tet) + " and " + std::to_string(other.tet) +
                                        " lie on the same side of " + named(one.key) + ", which they share");
        const int order = 4 * one.tet + one.opposite;
        if (next - k == 1)
            boundary.push_back({order, outward(tets[one.tet], one.opposite), {region[one.tet], -1}});
        else if (region[one.tet] != region[other.tet]) {
            const HalfFacet &from = region[one.tet] < region[other.tet] ? one : other;
            const auto sides = std::minmax(region[one.tet], region[other.tet]);
            interfaces.push_back({order, outward(tets[from.tet], from.opposite), {sides.first, sides.second}});
        }
    }
    SurfaceFacets out;
    for (auto *found : {&boundary, &interfaces}) {
        std::sort(found->begin(), found->end(), [](const Found &a, const Found &b) { return a.order < b.order; });
        for (const Found &one : *found) {
            out.triangles.push_back(one.triangle);
            out.sides.push_back(one.sides);
        }
    }
    return out;
}

} // namespace wct::library
