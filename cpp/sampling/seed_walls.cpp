#include "sampling/seed_walls.h"

#include <algorithm>
#include <optional>

namespace wct::sampling {

namespace {

// In cells of the lattice.
constexpr double kThickest = 1.6; // of a wall: in a thicker one, however it lies, there is a plane of the lattice
constexpr double kDeep = 0.52;    // least distance from the surface, as of the lattice's points
constexpr double kEmpty = 0.9;    // from the lattice's points: nowhere in the lattice, nor beside it, is so much room
constexpr double kApart = 0.75;   // from one another

struct Middle {
    Vec3 point;
    double depth; // in cells
    double size;
    int region;
};

} // namespace

void seed_walls(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
                const domain::Sizing &sizing, double cell_per_edge, const Workers &workers) {
    PointGrid lattice;
    for (std::size_t i = 0; i < cloud.count(); ++i)
        if (cloud.role[i] == Stratum::interior)
            lattice.add(cloud.points[i], kEmpty * cell_per_edge * cloud.size[i]);
    const auto opposite = [&](std::size_t i, int side) -> std::optional<Middle> {
        const Vec3 &p = cloud.points[i];
        const double cell = cell_per_edge * cloud.size[i];
        const int triangle = reference.nearest(p, cloud.label[i], cloud.near[i]).triangle;
        const Vec3 way = (side == 0 ? -1.0 : 1.0) * reference.normal(triangle);
        int hit = -1;
        const double far = reference.ray(p, way, reference.ray_start(), kThickest * cell, hit);
        if (hit < 0 || far < 2.0 * kDeep * cell)
            return {};
        const Vec3 middle = p + 0.5 * far * way;
        if (lattice.crowded(middle, kEmpty * cell))
            return {};
        const domain::Foot foot = reference.nearest(middle, -1, triangle);
        const double size = sizing.at(middle);
        const double depth = foot.distance / (cell_per_edge * size);
        const int region = map.region(middle, foot);
        if (region < 0 || depth < kDeep)
            return {};
        return Middle{middle, depth, size, region};
    };
    std::vector<std::array<std::optional<Middle>, 2>> found(cloud.count()); // behind and before a patch point
    workers.for_each(cloud.count(), 256, [&](std::size_t i) {
        for (int side = 0; side < 2 && cloud.role[i] == Stratum::patch; ++side)
            if (reference.data().sides[cloud.label[i]][side] >= 0)
                found[i][side] = opposite(i, side);
    });
    std::vector<Middle> middles;
    for (const auto &sides : found)
        for (const auto &middle : sides)
            if (middle)
                middles.push_back(*middle);
    std::stable_sort(middles.begin(), middles.end(),
                     [](const Middle &a, const Middle &b) { return a.depth > b.depth; });
    PointGrid taken;
    for (const Middle &middle : middles) {
        const double apart = kApart * cell_per_edge * middle.size;
        if (taken.crowded(middle.point, apart))
            continue;
        taken.add(middle.point, apart);
        cloud.add(middle.point, Stratum::interior, middle.region, middle.size);
    }
}

} // namespace wct::sampling
