#include "sampling/seeds.h"

#include "sampling/lattice_levels.h"
#include "sampling/seed_corners.h"
#include "sampling/seed_curves.h"
#include "sampling/seed_patches.h"
#include "sampling/seed_walls.h"
#include "sampling/sharp_edge_rows.h"

#include <algorithm>

namespace wct::sampling {

namespace {

/// In [-1, 1)^3.
Vec3 in_cube(Random &random) {
    const double x = 2.0 * random.uniform() - 1.0;
    const double y = 2.0 * random.uniform() - 1.0;
    return {x, y, 2.0 * random.uniform() - 1.0};
}

/// Lattice points of one level, found by cutting space into blocks and dropping those that cannot hold any.
class LatticeLevel {
  public:
    LatticeLevel(const domain::Reference &reference, const domain::RegionMap &map, const domain::Sizing &sizing,
                 const SeedForm &form, const std::optional<PartialRenewal> &renewal, int level,
                 const LatticeLevels &levels, Monitor &monitor)
        : reference_(reference), map_(map), sizing_(sizing), form_(form), renewal_(renewal), cell_(levels.cell(level)),
          level_(level), levels_(levels), monitor_(monitor) {}

    template <class Take> void collect(const geometry::Box &box, const Take &take) {
        const Vec3 extent = box.hi - box.lo;
        const double longest = std::max({extent.x, extent.y, extent.z});
        std::int64_t side = kBlock;
        while (static_cast<double>(side) * cell_ < longest + cell_)
            side *= 2;
        descend(box.lo, 0, 0, 0, side, take);
    }

  private:
    static constexpr std::int64_t kBlock = 4; // cells along the smallest blocks
    static constexpr double kCorner = 1.7321; // from a cube's middle to its corner, in halves of its side; rounded up
    static constexpr int kHear = 64;          // blocks after which who may stop the work is asked
    static constexpr double kLeast = 1e-3;    // size in a block, in that at its middle
    /// The lattice starts so many cells off the box, so that a box's own faces meet no lattice plane.
    static constexpr double kStart = 0.363;

    template <class Take>
    void descend(const Vec3 &origin, std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t side,
                 const Take &take) {
        if (monitor_.stopped())
            return;
        const double half = 0.5 * static_cast<double>(side) * cell_;
        const Vec3 center = origin + Vec3{static_cast<double>(i) * cell_ + half, static_cast<double>(j) * cell_ + half,
                                          static_cast<double>(k) * cell_ + half};
        const double radius = kCorner * half;
        if (!wanted(renewal_, center, radius))
            return;
        const domain::Foot foot = reference_.nearest(center);
        if (foot.distance > radius && map_.region(center, foot) < 0)
            return;
        if (levels_.count() > 1) {
            const double size = sizing_.at(center);
            const double change = sizing_.form().inner_grade * radius;
            if (levels_.of(std::max(size - change, kLeast * size)) > level_ || levels_.of(size + change) < level_)
                return;
        }
        if (side > kBlock) {
            const std::int64_t h = side / 2;
            for (int part = 0; part < 8; ++part)
                descend(origin, i + (part & 1 ? h : 0), j + (part & 2 ? h : 0), k + (part & 4 ? h : 0), h, take);
            return;
        }
        if (++blocks_ % kHear == 0)
            monitor_.ask();
        int hint = foot.triangle;
        for (std::int64_t a = i; a < i + side; ++a)
            for (std::int64_t b = j; b < j + side; ++b)
                for (std::int64_t c = k; c < k + side; ++c)
                    for (const double shift : {0.0, 0.5}) {
                        const Vec3 p = origin + cell_ * Vec3{static_cast<double>(a) + shift - kStart,
                                                             static_cast<double>(b) + shift - kStart,
                                                             static_cast<double>(c) + shift - kStart};
                        try_point(p, hint, take);
                    }
    }

    template <class Take> void try_point(const Vec3 &p, int &hint, const Take &take) const {
        const double size = sizing_.at(p);
        if (levels_.of(size) != level_)
            return;
        const domain::Foot foot = reference_.nearest(p, -1, hint);
        hint = foot.triangle;
        const auto &[behind, before] = reference_.data().sides[reference_.data().patch[foot.triangle]];
        const double depth = behind < 0 || before < 0 ? form_.least_depth : form_.interface_depth;
        if (foot.distance <= depth * cell_)
            return;
        const int region = map_.region(p, foot);
        if (region >= 0)
            take(p, size, region);
    }

    const domain::Reference &reference_;
    const domain::RegionMap &map_;
    const domain::Sizing &sizing_;
    const SeedForm &form_;
    const std::optional<PartialRenewal> &renewal_;
    double cell_;
    int level_;
    const LatticeLevels &levels_;
    Monitor &monitor_;
    int blocks_ = 0; // that were looked at point by point
};

} // namespace

void seed_inside(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
                 const domain::Sizing &sizing, const SeedForm &form, const std::optional<PartialRenewal> &renewal,
                 Random &random, Monitor &monitor) {
    geometry::Box box;
    for (const Vec3 &p : reference.data().points)
        box.add(p);
    std::vector<double> sizes = cloud.size;
    double finest = sizing.smallest();
    double least = finest;
    if (!sizes.empty()) { // a few outliers must not set the lattice's scale
        std::sort(sizes.begin(), sizes.end());
        finest = sizes[sizes.size() / SeedForm::outliers];
        least = sizes.front();
    }
    const LatticeLevels levels(sizing, finest, least, form.edge_per_cell, form.level_ratio);
    PointGrid wires; // the lattice keeps off what no surface tells of
    const std::vector<char> wire = on_wires(cloud, reference);
    for (std::size_t i = 0; i < wire.size(); ++i)
        if (wire[i] || cloud.role[i] == Stratum::interior) // these are at corners
            wires.add(cloud.points[i], form.wire_gap * cloud.size[i]);
    PointGrid grid;
    for (int level = 0; level < levels.count(); ++level) {
        const double cell = levels.cell(level);
        // Points of finer levels keep points of this one at a distance of a share of their mean cell.
        std::vector<Vec3> fresh;
        LatticeLevel(reference, map, sizing, form, renewal, level, levels, monitor)
            .collect(box, [&](const Vec3 &p, double size, int region) {
                if (wires.crowded(p, form.wire_gap * size) || (level > 0 && grid.crowded(p, form.level_gap * cell)))
                    return;
                cloud.add(p + (form.jitter * size) * in_cube(random), Stratum::interior, region, size);
                fresh.push_back(p);
            });
        for (const Vec3 &p : fresh)
            grid.add(p, form.level_gap * cell);
    }
}

Cloud make_seeds(const domain::Reference &reference, const domain::RegionMap &map, const domain::Sizing &sizing,
                 const SeedForm &form, const std::optional<PartialRenewal> &renewal, const HeldSurface *held,
                 Random &random, Monitor &monitor, const Workers &workers) {
    Cloud cloud;
    for (const int v : reference.data().corners)
        cloud.add(reference.data().points[v], Stratum::corner, v, sizing.at(reference.data().points[v]));
    seed_curves(cloud, reference, sizing);
    if (held)
        held->put(cloud, sizing);
    seed_sharp_rows(cloud, reference, sizing);
    seed_corners(cloud, reference, map, sizing);
    seed_patches(cloud, reference, sizing, form, renewal, random, monitor);
    seed_inside(cloud, reference, map, sizing, form, renewal, random, monitor);
    seed_walls(cloud, reference, map, sizing, 1.0 / form.edge_per_cell, workers);
    retract(cloud, reference, workers);
    clear_sharp(cloud, sizing);
    if (held) {
        held->drop_others(cloud);
        held->clear(cloud);
    }
    return cloud;
}

} // namespace wct::sampling
