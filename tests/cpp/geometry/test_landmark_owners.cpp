#include "geometry/landmark_owners.h"

#include "base/random.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

namespace wct::tests {

TEST_CASE("LandmarkOwners: an owner's list has what was handed to it and not on, the last first") {
    constexpr int owners = 4, landmarks = 9;
    geometry::LandmarkOwners<int> lists;
    std::vector<int> first(owners, -1);
    std::vector<std::vector<int>> wanted(owners);
    Random random(1);
    for (int l = 0; l < landmarks; ++l) {
        REQUIRE(lists.add() == l);
        lists.own(l, l % owners, first[l % owners]);
        wanted[l % owners].insert(wanted[l % owners].begin(), l);
    }
    for (int step = 0; step < 300; ++step) {
        const int l = static_cast<int>(random.below(landmarks)), to = static_cast<int>(random.below(owners));
        std::erase(wanted[lists.owner(l)], l);
        lists.disown(l, first[lists.owner(l)]);
        lists.own(l, to, first[to]);
        wanted[to].insert(wanted[to].begin(), l);
        for (int owner = 0; owner < owners; ++owner) {
            std::vector<int> found;
            for (int k = first[owner]; k >= 0; k = lists.next(k)) {
                found.push_back(k);
                REQUIRE(lists.owner(k) == owner);
            }
            REQUIRE(found == wanted[owner]);
        }
    }
    for (int step = 0; step < 100; ++step) { // and back to its place
        const int l = static_cast<int>(random.below(landmarks)), from = lists.owner(l), after = lists.previous(l);
        lists.disown(l, first[from]);
        lists.own(l, from, first[from], after);
        std::vector<int> found;
        for (int k = first[from]; k >= 0; k = lists.next(k)) {
            REQUIRE(lists.previous(k) == (found.empty() ? -1 : found.back()));
            found.push_back(k);
        }
        REQUIRE(found == wanted[from]);
    }
    CHECK(lists.count() == landmarks);
    lists.clear();
    CHECK(lists.count() == 0);
}

} // namespace wct::tests
