#pragma once

#include "move_vertices/anneal.h"
#include "move_vertices/moving_mesh.h"

#include <cstdint>
#include <span>
#include <vector>

namespace wct::move_vertices {

/// What a set of positions is worth.
struct Verdict {
    std::int64_t well_centered = 0; // tets that contain their circumcenter: exact
    std::int64_t meeting = 0;       // tets that meet the goal: exact
    double worst = 1.0;             // smallest h/R (and cosine, if the goal asks)
    double shortfall = 0.0; // sum over tets of what they miss of the margin, each counted up to the margin itself
    bool valid = true;      // no tet inverted: exact
};

class PositionJudge {
  public:
    static constexpr double kRounding = 1e-9; // worst values this near each other are the same

    PositionJudge(Goal goal, double margin) : goal_(goal), margin_(margin) {}

    /// Over all tets, whether they can move or not.
    Verdict judge(std::span<const Vec3> points, std::span<const Tet> tets) const;

    /// Which tets meet the goal.
    std::vector<bool> meeting(std::span<const Vec3> points, std::span<const Tet> tets) const;

    /// Is `candidate` an improvement on `best`, for a mesh that came in as `start`?
    /// Never with fewer well-centered tets than at the start, nor, where all met the goal, with a smaller worst value.
    bool better(const Verdict &candidate, const Verdict &best, const Verdict &start, std::size_t tets) const;

  private:
    Goal goal_;
    double margin_;
};

} // namespace wct::move_vertices
