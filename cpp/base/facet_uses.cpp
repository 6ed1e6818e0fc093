#include "base/facet_uses.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace wct {

FacetUses::FacetUses(std::span<const Tet> tets, std::size_t points) : first_(points + 1, 0), uses_(4 * tets.size()) {
    for (const Tet &tet : tets)
        for (int i = 0; i < 4; ++i)
            ++first_[sorted(inward_facet(tet, i))[0] + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t half = 0; half < uses_.size(); ++half) {
        const Facet key = sorted(inward_facet(tets[half / 4], static_cast<int>(half % 4)));
        uses_[next[key[0]]++] = {{key[1], key[2]}, static_cast<std::int32_t>(half)};
    }
    for (std::size_t v = 0; v < points; ++v)
        std::sort(uses_.begin() + first_[v], uses_.begin() + first_[v + 1],
                  [](const Use &a, const Use &b) { return std::tie(a.others, a.half) < std::tie(b.others, b.half); });
}

std::span<const FacetUses::Use> FacetUses::of(const Facet &key) const {
    const auto row = std::span(uses_).subspan(first_[key[0]], first_[key[0] + 1] - first_[key[0]]);
    const Edge others{key[1], key[2]};
    const auto begin = std::partition_point(row.begin(), row.end(), [&](const Use &u) { return u.others < others; });
    const auto end = std::find_if(begin, row.end(), [&](const Use &u) { return u.others != others; });
    return {begin, end};
}

} // namespace wct
