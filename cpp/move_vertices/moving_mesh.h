#pragma once

#include "base/vec3.h"
#include "energy/energy.h"
#include "move_vertices/problem.h"

#include <cstdint>
#include <span>
#include <vector>

namespace wct::move_vertices {

/// A tet around a vertex: which one, and its other corners in the order that makes (vertex, others...) positive.
struct StarTet {
    std::int32_t tet;
    std::int32_t other[3];
};

/// Flatness (det / longest edge^3, 0.71 for the regular tet) at which squeezing a tet for the sake of others ends.
/// Movers that let hopeless tets go would leave slivers without it; it costs them next to nothing (measured: no
/// well-centered tets up to 0.03, under one in a hundred at 0.06).
inline constexpr double kFlattest = 0.03;

/// A mesh of fixed connectivity whose points move, with what every mover needs to know about it.
///
/// No tet may become flatter than kFlattest, except that one which came in flatter may stay as flat as it was, so that
/// it does not nail its corners down for ever; none may turn inside out, which is decided exactly.
class MovingMesh {
  public:
    /// `free` marks the points that may move. All tets must be positive.
    MovingMesh(std::vector<Vec3> points, std::vector<Tet> tets, const std::vector<bool> &free);

    std::vector<Vec3> points;

    const std::vector<Tet> &tets() const { return tets_; }
    /// Points that may move and have tets, ascending.
    const std::vector<std::int32_t> &free() const { return free_; }
    /// Tets with a corner that may move, ascending.
    const std::vector<std::int32_t> &active() const { return active_; }
    /// The tets around a free point.
    std::span<const StarTet> star(std::int32_t point) const {
        return {stars_.data() + offsets_[static_cast<std::size_t>(point)],
                stars_.data() + offsets_[static_cast<std::size_t>(point) + 1]};
    }
    double floor(std::int32_t tet) const { return floors_[static_cast<std::size_t>(tet)]; }
    /// Mean edge length around a free point at the start: the unit of its steps.
    double size(std::int32_t point) const { return sizes_[static_cast<std::size_t>(point)]; }

    /// Is the tet positive, given the flatness floating point found for it?
    bool positive(std::int32_t tet, double flatness, std::span<const Vec3> at) const;

  private:
    std::vector<Tet> tets_;
    std::vector<std::int32_t> free_;
    std::vector<std::int32_t> active_;
    std::vector<std::size_t> offsets_;
    std::vector<StarTet> stars_;
    std::vector<double> floors_;
    std::vector<double> sizes_;
};

/// Load up to kLanes tets; spare lanes repeat the last one.
void load_tets(std::span<const Vec3> points, std::span<const Tet> tets, std::span<const std::int32_t> which,
               energy::TetLanes &lanes);

} // namespace wct::move_vertices
