#pragma once

#include "base/cells.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace wct::geometry {

/// The edges of some tets, each once, in the order of their ends; and of each tet, where its six stand, as kEdges.
struct EdgeTable {
    std::vector<Edge> edges;
    std::vector<std::array<std::int32_t, 6>> of_tets;
};

/// `points`: how many there are.
EdgeTable edge_table(std::span<const Tet> tets, std::size_t points);

} // namespace wct::geometry
