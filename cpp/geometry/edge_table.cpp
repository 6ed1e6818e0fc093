#include "geometry/edge_table.h"

#include <algorithm>
#include <numeric>

namespace wct::geometry {

EdgeTable edge_table(std::span<const Tet> tets, std::size_t points) {
    struct Use {
        std::int32_t other; // end, the larger one
        std::int32_t tet;
        std::int32_t k;
    };
    // In rows by the smaller end: many short rows are sorted in far less time than one long one.
    std::vector<std::size_t> first(points + 1, 0);
    for (const Tet &tet : tets)
        for (const auto &edge : kEdges)
            ++first[std::min(tet[edge[0]], tet[edge[1]]) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<Use> uses(6 * tets.size());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (int k = 0; k < 6; ++k) {
            const auto [low, high] = std::minmax(tets[t][kEdges[k][0]], tets[t][kEdges[k][1]]);
            uses[next[low]++] = {high, static_cast<std::int32_t>(t), k};
        }
    EdgeTable out;
    out.of_tets.resize(tets.size());
    for (std::size_t v = 0; v < points; ++v) {
        const auto begin = uses.begin() + first[v], end = uses.begin() + first[v + 1];
        std::sort(begin, end, [](const Use &a, const Use &b) { return a.other < b.other; });
        for (auto use = begin; use != end; ++use) {
            if (use == begin || use->other != (use - 1)->other)
                out.edges.push_back({static_cast<std::int32_t>(v), use->other});
            out.of_tets[use->tet][use->k] = static_cast<std::int32_t>(out.edges.size()) - 1;
        }
    }
    return out;
}

} // namespace wct::geometry
