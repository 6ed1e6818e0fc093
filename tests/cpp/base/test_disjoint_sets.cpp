#include "base/disjoint_sets.h"

#include "base/random.h"

#include <doctest/doctest.h>

#include <set>
#include <vector>

namespace wct::tests {

TEST_CASE("DisjointSets: the same sets as by painting over labels") {
    Random random(1);
    for (const int count : {1, 2, 10, 200}) {
        DisjointSets sets(count);
        std::vector<int> paint(count);
        for (int k = 0; k < count; ++k)
            paint[k] = k;
        CHECK(sets.count() == count);
        for (int step = 0; step < count; ++step) {
            const int a = random.below(count), b = random.below(count);
            sets.join(a, b);
            const int old = paint[a], fresh = paint[b];
            for (int &p : paint)
                if (p == old)
                    p = fresh;
            CHECK(sets.count() == static_cast<int>(std::set<int>(paint.begin(), paint.end()).size()));
            for (int k = 0; k < 20; ++k) {
                const int x = random.below(count), y = random.below(count);
                CHECK((sets.find(x) == sets.find(y)) == (paint[x] == paint[y]));
            }
            CHECK(sets.find(sets.find(a)) == sets.find(a));
        }
    }
}

} // namespace wct::tests
