#pragma once

#include "domain/sizing.h"

#include <algorithm>
#include <cmath>

namespace wct::sampling {

/// The cells that a lattice follows a size field with: in steps, the finest first, and rounded down between them.
class LatticeLevels {
  public:
    /// From cells for `finest`, with some for sizes as small as `least` before, to those for the largest size there is.
    /// `step`: ratio of one level's cells to those of the level before, about.
    LatticeLevels(const domain::Sizing &sizing, double finest, double least, double edge_per_cell, double step)
        : edge_per_cell_(edge_per_cell) {
        finest /= edge_per_cell;
        least /= edge_per_cell;
        const double coarsest = sizing.form().coarsen * sizing.largest() / edge_per_cell;
        // Both ends of the range of sizes are met exactly: a coarser wish rounded down to the level below costs tets.
        const double range = std::log(std::max(1.0, coarsest / finest));
        const int steps = static_cast<int>(std::lround(range / std::log(step)));
        ratio_ = steps > 0 ? std::exp(range / steps) : step;
        if (steps == 0) // one level in all, but for outliers: that of most of the volume
            finest = coarsest;
        // The outliers get levels of their own: cells coarser than their size leave them with too few points.
        const int finer = static_cast<int>(std::ceil(std::log(finest / least) / std::log(ratio_) - kSlack));
        count_ = 1 + steps + finer;
        finest_ = finest * std::pow(ratio_, -finer);
    }

    int count() const { return count_; }
    double cell(int level) const { return finest_ * std::pow(ratio_, level); }
    int of(double size) const {
        const double steps = std::log(size / edge_per_cell_ / finest_) / std::log(ratio_);
        return std::clamp(static_cast<int>(std::floor(steps + kSlack)), 0, count_ - 1);
    }

  private:
    static constexpr double kSlack = 0.05; // levels by which a size may miss one and still be of it

    double edge_per_cell_;
    double ratio_;
    double finest_;
    int count_;
};

} // namespace wct::sampling
