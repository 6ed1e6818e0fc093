#include "library/surface_facets.h"

#include "base/facet_uses.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace wct::library {

namespace {

std::string named(const Facet &facet) {
    return "facet (" + std::to_string(facet[0]) + ", " + std::to_string(facet[1]) + ", " + std::to_string(facet[2]) +
           ")";
}

std::size_t points_of(std::span<const Tet> tets) {
    int largest = -1;
    for (const Tet &tet : tets)
        largest = std::max(largest, *std::max_element(tet.begin(), tet.end()));
    return static_cast<std::size_t>(largest + 1);
}

bool same_side(std::span<const Tet> tets, const FacetUses::Use &one, const FacetUses::Use &other) {
    Facet facet = inward_facet(tets[one.tet()], one.corner()), back = inward_facet(tets[other.tet()], other.corner());
    return ascend(facet) == ascend(back);
}

} // namespace

SurfaceFacets surface_of(std::span<const Tet> tets, std::span<const int> region) {
    struct Found {
        std::int32_t order;
        Facet triangle;
        std::array<int, 2> sides;
    };
    std::vector<Found> boundary, interfaces;
    FacetUses(tets, points_of(tets)).each([&](const Facet &key, std::span<const FacetUses::Use> uses) {
        const FacetUses::Use &one = uses.front(), &other = uses.back();
        if (uses.size() > 2)
            throw std::invalid_argument(named(key) + " belongs to tets " + std::to_string(one.tet()) + ", " +
                                        std::to_string(uses[1].tet()) + " and " + std::to_string(other.tet()) +
                                        "; at most two may share one");
        if (uses.size() == 2 && same_side(tets, one, other))
            throw std::invalid_argument("tets " + std::to_string(one.tet()) + " and " + std::to_string(other.tet()) +
                                        " lie on the same side of " + named(key) + ", which they share");
        const auto outward = [&](const FacetUses::Use &use) { return outward_facet(tets[use.tet()], use.corner()); };
        const int here = region[one.tet()], there = region[other.tet()];
        if (uses.size() == 1)
            boundary.push_back({one.half, outward(one), {here, -1}});
        else if (here != there)
            interfaces.push_back(
                {one.half, outward(here < there ? one : other), {std::min(here, there), std::max(here, there)}});
    });
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
