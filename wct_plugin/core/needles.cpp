#include "needles.h"

#include "cells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace wct {

namespace {

/// The angle between a tet's facets at its edge ab; p and q are the other corners.
double dihedral(const Vec3 &a, const Vec3 &b, const Vec3 &p, const Vec3 &q) {
    const Vec3 m = cross(b - a, p - a), n = cross(b - a, q - a);
    return std::atan2(norm(cross(m, n)), dot(m, n));
}

} // namespace

std::vector<double> needle_cosines(std::span<const Vec3> points, std::span<const Tet> tets,
                                   std::span<const int> regions, std::span<const std::array<int, 2>> creases) {
    std::vector<char> on_crease(points.size(), 0);
    std::map<std::array<int, 2>, std::map<int, double>> filled; // crease edge -> region -> its angle
    for (const auto &[v, w] : creases) {
        filled[{std::min(v, w), std::max(v, w)}];
        on_crease[v] = on_crease[w] = 1;
    }
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (const auto &[i, j] : kEdges) {
            const int v = tets[t][i], w = tets[t][j];
            if (!on_crease[v] || !on_crease[w])
                continue;
            const auto found = filled.find({std::min(v, w), std::max(v, w)});
            if (found == filled.end())
                continue;
            std::array<int, 2> others{};
            int k = 0;
            for (const int u : tets[t])
                if (u != v && u != w)
                    others[k++] = u;
            found->second[regions[t]] += dihedral(points[v], points[w], points[others[0]], points[others[1]]);
        }
    std::vector<double> needle(points.size(), Vertex{}.needle);
    for (const auto &[edge, angles] : filled)
        for (const auto &[region, angle] : angles)
            if (angle < 1.5707963267948966)
                for (const int v : edge)
                    needle[v] = std::max(needle[v], std::cos(angle));
    return needle;
}

} // namespace wct
