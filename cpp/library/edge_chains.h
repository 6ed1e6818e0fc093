#pragma once

#include "base/cells.h"
#include "base/vec3.h"

#include <cstdint>
#include <span>
#include <vector>

namespace wct::library {

/// The segments that meet at each point.
class SegmentEnds {
  public:
    SegmentEnds(std::span<const Edge> segments, std::size_t points);

    int degree(int v) const { return degree_[v]; }
    /// The first and the last segment at v; of those that are there at all.
    const std::array<int, 2> &at(int v) const { return at_[v]; }

  private:
    std::vector<int> degree_;
    std::vector<std::array<int, 2>> at_;
};

/// Per segment the number of its chain: two that meet at a point with no other segment, and no break, are in one.
std::vector<int> chains_of(std::span<const Edge> segments, std::span<const std::uint8_t> breaks);

/// Per point whether other than two segments meet there, or two at a turn of more than 45 degrees.
std::vector<std::uint8_t> ends_and_turns(std::span<const Vec3> points, std::span<const Edge> segments);

} // namespace wct::library
