#include "base/facet_uses.h"

#include "base/random.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <vector>

namespace wct::tests {

TEST_CASE("FacetUses: who has a facet is who has its three corners") {
    constexpr int points = 12;
    Random random(1);
    std::vector<Tet> tets;
    while (tets.size() < 60) { // any four points: facets of many tets are among them
        Tet tet;
        for (int &v : tet)
            v = static_cast<int>(random.below(points));
        Tet different = tet;
        std::sort(different.begin(), different.end());
        if (std::adjacent_find(different.begin(), different.end()) == different.end())
            tets.push_back(tet);
    }
    std::map<Facet, std::vector<int>> wanted; // with the tets as 4 * tet + the corner opposite
    for (int t = 0; t < static_cast<int>(tets.size()); ++t)
        for (int i = 0; i < 4; ++i) {
            Facet key{tets[t][(i + 1) % 4], tets[t][(i + 2) % 4], tets[t][(i + 3) % 4]};
            std::sort(key.begin(), key.end());
            wanted[key].push_back(4 * t + i);
        }
    const FacetUses uses(tets, points + 2); // the last two are of no tet
    std::vector<Facet> keys;
    uses.each([&](const Facet &key, std::span<const FacetUses::Use> found) {
        keys.push_back(key);
        std::vector<int> halves;
        for (const FacetUses::Use &use : found) {
            halves.push_back(4 * use.tet() + use.corner());
            CHECK(std::find(key.begin(), key.end(), tets[use.tet()][use.corner()]) == key.end());
        }
        CHECK(halves == wanted.at(key));
        CHECK(uses.of(key).size() == halves.size());
        CHECK(uses.of(key).data() == found.data());
    });
    CHECK(keys.size() == wanted.size());
    CHECK(std::is_sorted(keys.begin(), keys.end()));
    for (int a = 0; a < points; ++a)
        for (int b = a + 1; b < points; ++b)
            for (int c = b + 1; c < points + 2; ++c)
                CHECK(uses.of({a, b, c}).empty() == !wanted.contains({a, b, c}));
}

} // namespace wct::tests
