#include "geometry/euler_characteristic.h"

#include <algorithm>
#include <cstddef>

namespace wct::geometry {

namespace {

/// Add `sign` times the number of different cells with `size` corners to the regions they belong to.
template <std::size_t size>
void count(std::span<const Tet> tets, std::span<const int> region, int sign, std::vector<int> &sum) {
    std::vector<std::array<int, size + 1>> cells; // region, then corners ascending
    for (std::size_t t = 0; t < tets.size(); ++t) {
        if (region[t] < 0)
            continue;
        Tet tet = tets[t];
        std::sort(tet.begin(), tet.end());
        for (unsigned chosen = 0; chosen < 16; ++chosen) {
            std::array<int, size + 1> cell{region[t]};
            std::size_t at = 0;
            for (unsigned k = 0; k < 4; ++k)
                if (chosen >> k & 1U && ++at <= size)
                    cell[at] = tet[k];
            if (at == size)
                cells.push_back(cell);
        }
    }
    std::sort(cells.begin(), cells.end());
    for (std::size_t k = 0; k < cells.size(); ++k)
        if (k == 0 || cells[k] != cells[k - 1])
            sum[cells[k][0]] += sign;
}

} // namespace

std::vector<int> euler_characteristics(std::span<const Tet> tets, std::span<const int> region) {
    int regions = 0;
    for (const int r : region)
        regions = std::max(regions, r + 1);
    std::vector<int> sum(regions, 0);
    count<1>(tets, region, 1, sum);
    count<2>(tets, region, -1, sum);
    count<3>(tets, region, 1, sum);
    count<4>(tets, region, -1, sum);
    return sum;
}

} // namespace wct::geometry
