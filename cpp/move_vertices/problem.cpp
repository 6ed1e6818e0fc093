#include "move_vertices/problem.h"

#include "geometry/box_tree.h"

#include <algorithm>
#include <numeric>

namespace wct::move_vertices {

namespace {

/// Spread the low 21 bits two places apart.
std::uint64_t spread(std::uint64_t bits) {
    bits = (bits | bits << 32) & 0x001f00000000ffffull;
    bits = (bits | bits << 16) & 0x001f0000ff0000ffull;
    bits = (bits | bits << 8) & 0x100f00f00f00f00full;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3ull;
    return (bits | bits << 2) & 0x1249249249249249ull;
}

} // namespace

std::vector<std::int32_t> spatial_order(const std::vector<Vec3> &points) {
    std::vector<std::int32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    if (points.empty())
        return order;
    geometry::Box box;
    for (const Vec3 &p : points)
        box.add(p);
    const auto &[low, high] = box;
    const double extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
    std::vector<std::uint64_t> key(points.size());
    const auto cell = [extent](double offset) {
        const double share = offset / extent; // NaN for a single place, beyond 1 after an overflow
        return share > 0.0 ? static_cast<std::uint64_t>(std::min(share, 1.0) * 0x1fffff) : 0;
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 d = points[i] - low;
        key[i] = spread(cell(d.x)) | spread(cell(d.y)) << 1 | spread(cell(d.z)) << 2;
    }
    std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
        return key[static_cast<std::size_t>(a)] < key[static_cast<std::size_t>(b)];
    });
    return order;
}

Problem renumbered(const Problem &problem, const std::vector<std::int32_t> &order) {
    Problem out = problem;
    std::vector<std::int32_t> rank(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const auto from = static_cast<std::size_t>(order[i]);
        rank[from] = static_cast<std::int32_t>(i);
        out.points[i] = problem.points[from];
        out.stratum[i] = problem.stratum[from];
        out.label[i] = problem.label[from];
    }
    const auto renumber = [&rank](auto &cells) {
        for (auto &cell : cells)
            for (auto &corner : cell)
                corner = rank[static_cast<std::size_t>(corner)];
    };
    renumber(out.tets);
    renumber(out.triangles);
    renumber(out.segments);
    std::stable_sort(out.tets.begin(), out.tets.end(), [](const Tet &a, const Tet &b) {
        return *std::min_element(a.begin(), a.end()) < *std::min_element(b.begin(), b.end());
    });
    return out;
}

} // namespace wct::move_vertices
