#pragma once

#include <array>
#include <cstdint>
#include <utility>

namespace wct {

using Tet = std::array<std::int32_t, 4>;
using Facet = std::array<std::int32_t, 3>;
using Edge = std::array<std::int32_t, 2>;

/// What a point is free to do: anything; stay on its patch of the surface; stay on its crease; stay.
enum class Stratum : std::int8_t { interior = 0, patch = 1, crease = 2, corner = 3 };

/// Facet i lies opposite corner i; (kFacets[i], i) is an even permutation, so that it winds towards corner i.
inline constexpr int kFacets[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
/// The same facets seen from outside: they wind away from their corner.
inline constexpr int kOutward[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
inline constexpr int kEdges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/// Facet i of a tet; it winds towards corner i.
inline Facet inward_facet(const Tet &tet, int i) {
    return {tet[kFacets[i][0]], tet[kFacets[i][1]], tet[kFacets[i][2]]};
}
/// The same seen from outside.
inline Facet outward_facet(const Tet &tet, int i) {
    return {tet[kOutward[i][0]], tet[kOutward[i][1]], tet[kOutward[i][2]]};
}

/// Sort three numbers; true if the order's sense was kept.
inline bool ascend(Facet &f) {
    bool even = true;
    for (const auto &[i, j] : {Edge{0, 1}, Edge{1, 2}, Edge{0, 1}})
        if (f[i] > f[j]) {
            std::swap(f[i], f[j]);
            even = !even;
        }
    return even;
}

/// An edge or a facet with its ends or corners in ascending order, as keys are.
inline Edge sorted(int a, int b) {
    return a < b ? Edge{a, b} : Edge{b, a};
}
inline Facet sorted(int a, int b, int c) {
    if (a > b)
        std::swap(a, b);
    if (b > c)
        std::swap(b, c);
    if (a > b)
        std::swap(a, b);
    return {a, b, c};
}
inline Facet sorted(const Facet &f) {
    return sorted(f[0], f[1], f[2]);
}

} // namespace wct
