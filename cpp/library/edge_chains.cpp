#include "library/edge_chains.h"

#include "base/disjoint_sets.h"

#include <numbers>

namespace wct::library {

namespace {

/// A crease that turns by more at a point has a corner there, in radians.
constexpr double kCornerTurn = 45.0 / 180.0 * std::numbers::pi;

} // namespace

SegmentEnds::SegmentEnds(std::span<const Edge> segments, std::size_t points)
    : degree_(points, 0), at_(points, {-1, -1}) {
    for (std::size_t s = 0; s < segments.size(); ++s)
        for (const int v : segments[s])
            at_[v][degree_[v]++ > 0] = static_cast<int>(s);
}

std::vector<int> chains_of(std::span<const Edge> segments, std::span<const std::uint8_t> breaks) {
    const SegmentEnds ends(segments, breaks.size());
    DisjointSets chains(segments.size());
    for (std::size_t v = 0; v < breaks.size(); ++v)
        if (ends.degree(static_cast<int>(v)) == 2 && !breaks[v])
            chains.join(ends.at(static_cast<int>(v))[0], ends.at(static_cast<int>(v))[1]);
    return chains.numbers();
}

std::vector<std::uint8_t> ends_and_turns(std::span<const Vec3> points, std::span<const Edge> segments) {
    const SegmentEnds ends(segments, points.size());
    const auto other = [&](int s, int v) { return points[segments[s][0] == v ? segments[s][1] : segments[s][0]]; };
    std::vector<std::uint8_t> out(points.size(), 0);
    for (std::size_t k = 0; k < points.size(); ++k) {
        const int v = static_cast<int>(k);
        if (ends.degree(v) == 2) {
            const auto &[a, b] = ends.at(v);
            out[k] = angle(points[k] - other(a, v), other(b, v) - points[k]) > kCornerTurn;
        } else
            out[k] = ends.degree(v) > 0;
    }
    return out;
}

} // namespace wct::library
