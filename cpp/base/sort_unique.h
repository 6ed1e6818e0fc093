#pragma once

#include <algorithm>
#include <vector>

namespace wct {

/// Each value once, in ascending order.
template <class Value> void sort_unique(std::vector<Value> &values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

} // namespace wct
