#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace wct {

/// Disjoint sets of the numbers below a limit (union-find with path halving).
class DisjointSets {
  public:
    explicit DisjointSets(std::size_t count) : root_(count) { std::iota(root_.begin(), root_.end(), 0); }
    /// The number that stands for the set of x, until sets are joined.
    int find(int x) {
        while (root_[x] != x)
            x = root_[x] = root_[root_[x]];
        return x;
    }
    void join(int x, int y) { root_[find(x)] = find(y); }
    /// How many sets there are.
    int count() {
        int groups = 0;
        for (std::size_t k = 0; k < root_.size(); ++k)
            groups += find(static_cast<int>(k)) == static_cast<int>(k);
        return groups;
    }

    /// Per number that of its set; sets are numbered in the order of their least members.
    std::vector<int> numbers() {
        std::vector<int> number(root_.size(), -1), out(root_.size());
        int next = 0;
        for (std::size_t k = 0; k < root_.size(); ++k) {
            int &of = number[find(static_cast<int>(k))];
            if (of < 0)
                of = next++;
            out[k] = of;
        }
        return out;
    }

  private:
    std::vector<int> root_;
};

} // namespace wct
