#pragma once

#include "base/sort_unique.h"
#include "base/vec3.h"

#include <algorithm>
#include <array>
#include <functional>
#include <queue>
#include <span>
#include <utility>
#include <vector>

namespace wct::domain {

/// Lower `size` until it grows no faster than `grade` along the edges.
inline void limit_gradient(std::vector<double> &size, std::span<const Vec3> points,
                           const std::vector<std::vector<int>> &around, double grade) {
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (std::size_t v = 0; v < size.size(); ++v)
        queue.emplace(size[v], static_cast<int>(v));
    while (!queue.empty()) {
        const auto [value, v] = queue.top();
        queue.pop();
        if (value > size[v])
            continue;
        for (const int w : around[v]) {
            const double limit = value + grade * norm(points[w] - points[v]);
            if (limit < size[w]) {
                size[w] = limit;
                queue.emplace(limit, w);
            }
        }
    }
}

template <std::size_t n>
std::vector<std::vector<int>> neighbours(const std::vector<std::array<int, n>> &cells, std::size_t count) {
    std::vector<std::vector<int>> around(count);
    for (const auto &cell : cells)
        for (const int v : cell)
            for (const int w : cell)
                if (v != w)
                    around[v].push_back(w);
    for (auto &list : around)
        sort_unique(list);
    return around;
}

} // namespace wct::domain
