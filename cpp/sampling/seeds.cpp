#include "sampling/seeds.h"

#include "sampling/lattice_levels.h"
#include "sampling/seed_corners.h"
#include "sampling/seed_curves.h"
#include "sampling/seed_patches.h"
#include "sampling/seed_walls.h"
#include "sampling/sharp_edge_rows.h"
#include "sampling/square_edge_rows.h"

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

    /// take(point, size, region) for one after the other, always in the same order.
    template <class Take> void collect(const geometry::Box &box, const Workers &workers, const Take &take) {
        const Vec3 extent = box.hi - box.lo;
        const double longest = std::max({extent.x, extent.y, extent.z});
        std::int64_t side = kBlock;
        while (static_cast<double>(side) * cell_ < longest + cell_)
            side *= 2;
        origin_ = box.lo;
        blocks_.clear();
        find_blocks(0, 0, 0, side);
        workers.in_order<std::vector<Seed>>(
            blocks_.size(), kTogether,
            [&](std::size_t first, std::size_t last, std::vector<Seed> &seeds) {
                seeds.clear();
                for (std::size_t block = first; block < last && !monitor_.stopped(); ++block)
                    fill(blocks_[block], seeds);
            },
            [&](std::size_t, std::size_t, const std::vector<Seed> &seeds) {
                monitor_.ask();
                for (const auto &[point, size, region] : seeds)
                    take(point, size, region);
            });
    }

  private:
    static constexpr std::int64_t kBlock = 4;   // cells along the smallest blocks
    static constexpr double kCorner = 1.7321;   // from a cube's middle to its corner, in halves of its side; rounded up
    static constexpr std::size_t kTogether = 8; // blocks that one thread looks at
    static constexpr std::size_t kHear = 4096;  // blocks found after which who may stop the work is asked
    static constexpr double kLeast = 1e-3;      // size in a block, in that at its middle
    /// The lattice starts so many cells off the box, so that a box's own faces meet no lattice plane.
    static constexpr double kStart = 0.363;

    /// One of the smallest blocks: its first cell, and a triangle of the surface that is near.
    struct Block {
        std::array<std::int64_t, 3> cell;
        int near;
    };
    struct Seed {
        Vec3 point;
        double size;
        int region;
    };

    void find_blocks(std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t side) {
        if (monitor_.stopped())
            return;
        const double half = 0.5 * static_cast<double>(side) * cell_;
        const Vec3 center = origin_ + Vec3{static_cast<double>(i) * cell_ + half, static_cast<double>(j) * cell_ + half,
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
                find_blocks(i + (part & 1 ? h : 0), j + (part & 2 ? h : 0), k + (part & 4 ? h : 0), h);
            return;
        }
        blocks_.push_back({{i, j, k}, foot.triangle});
        if (blocks_.size() % kHear == 0)
            monitor_.ask();
    }

    void fill(const Block &block, std::vector<Seed> &seeds) const {
        const auto [i, j, k] = block.cell;
        Hints hints{block.near, -1};
        for (std::int64_t a = i; a < i + kBlock; ++a)
            for (std::int64_t b = j; b < j + kBlock; ++b)
                for (std::int64_t c = k; c < k + kBlock; ++c)
                    for (const double shift : {0.0, 0.5})
                        try_point(origin_ + cell_ * Vec3{static_cast<double>(a) + shift - kStart,
                                                         static_cast<double>(b) + shift - kStart,
                                                         static_cast<double>(c) + shift - kStart},
                                  hints, seeds);
    }

    /// Triangles of the surface that were nearest to, and limited the size at, the point before.
    struct Hints {
        int near;
        int limiting;
    };

    void try_point(const Vec3 &p, Hints &hints, std::vector<Seed> &seeds) const {
        const double size = sizing_.at(p, hints.limiting);
        if (levels_.of(size) != level_)
            return;
        const domain::Foot foot = reference_.nearest(p, -1, hints.near);
        hints.near = foot.triangle;
        const bool inner = reference_.inner(reference_.data().patch[foot.triangle]);
        const double depth = inner ? form_.interface_depth : form_.least_depth;
        if (foot.distance <= depth * cell_)
            return;
        const int region = map_.region(p, foot);
        if (region >= 0)
            seeds.push_back({p, size, region});
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
    Vec3 origin_;
    std::vector<Block> blocks_; // that are to be looked at point by point
};

} // namespace

void seed_inside(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
                 const domain::Sizing &sizing, const SeedForm &form, const std::optional<PartialRenewal> &renewal,
                 Random &random, Monitor &monitor, const Workers &workers) {
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
            .collect(box, workers, [&](const Vec3 &p, double size, int region) {
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
    seed_corners(cloud, reference, map, sizing, seed_square_rows(cloud, reference, map, sizing));
    seed_patches(cloud, reference, sizing, form, renewal, random, monitor);
    seed_inside(cloud, reference, map, sizing, form, renewal, random, monitor, workers);
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
