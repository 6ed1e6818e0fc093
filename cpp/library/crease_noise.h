#pragma once

#include "geometry/triangle_edges.h"

#include <cstdint>
#include <span>
#include <vector>

namespace wct::library {

/// Of the edges of a surface, what makes them creases. Flags per edge.
struct CreaseEdges {
    std::vector<std::uint8_t> crease;
    std::vector<std::uint8_t> hard; // other than its angle makes it one
};

/// Drop creases that are noise of the tessellation: short dangling ones, and rims of a few triangles inside a patch.
/// `pinned`: per point whether a crease may end there.
void drop_noise(std::span<const Vec3> points, std::size_t triangles, const geometry::TriangleEdges &edges,
                std::span<const std::uint8_t> pinned, CreaseEdges &creases);

/// Per triangle the number of its patch: what hangs together over edges that are no creases.
std::vector<int> patches_between(const geometry::TriangleEdges &edges, std::span<const std::uint8_t> crease,
                                 std::size_t triangles);

} // namespace wct::library
