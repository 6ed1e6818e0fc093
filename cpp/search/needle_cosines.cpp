#include "search/needle_cosines.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace wct::search {

std::vector<double> needle_cosines(std::span<const Vec3> points, std::span<const Tet> tets,
                                   std::span<const int> regions, std::span<const Edge> creases) {
    std::vector<char> on_crease(points.size(), 0);
    std::map<Edge, std::map<int, double>> filled; // crease edge -> region -> its angle
    for (const auto &[v, w] : creases) {
        filled[sorted(v, w)];
        on_crease[v] = on_crease[w] = 1;
    }
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (int e = 0; e < 6; ++e) {
            const int v = tets[t][kEdges[e][0]], w = tets[t][kEdges[e][1]];
            if (!on_crease[v] || !on_crease[w])
                continue;
            const auto found = filled.find(sorted(v, w));
            if (found == filled.end())
                continue;
            const auto &[p, q] = kEdges[5 - e]; // the opposite edge
            const Vec3 along = points[w] - points[v];
            found->second[regions[t]] +=
                angle(cross(along, points[tets[t][p]] - points[v]), cross(along, points[tets[t][q]] - points[v]));
        }
    std::vector<double> needle(points.size(), Vertex{}.needle);
    for (const auto &[edge, angles] : filled)
        for (const auto &[region, sum] : angles)
            if (sum < std::numbers::pi / 2.0)
                for (const int v : edge)
                    needle[v] = std::max(needle[v], std::cos(sum));
    return needle;
}

} // namespace wct::search
