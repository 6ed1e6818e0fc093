#pragma once

#include "energy/energy.h"
#include "move_vertices/moving_mesh.h"

#include <cstddef>
#include <span>
#include <vector>

namespace wct::move_vertices {

/// Per tet: how much it counts, and the values its smallest h/R and cosine may not fall to.
struct Emphasis {
    std::vector<double> weight;
    std::vector<double> height;
    std::vector<double> cosine;
};

/// The energy of a moving mesh: of all of it, or of the tets around one point.
/// Infinite where a tet turns inside out, becomes too flat or breaks a bound of the emphasis.
class Objective {
  public:
    Objective(const energy::EnergyForm &form, Emphasis emphasis = {}) : form_(form), emphasis_(std::move(emphasis)) {}

    /// Sum over the tets that have a corner that may move, with the points at `at`; `gradient` (one entry per point) is
    /// overwritten. Counted evaluations are added to `work`.
    double total(const MovingMesh &mesh, std::span<const Vec3> at, std::span<Vec3> gradient, std::size_t &work) const;

    /// Sum over the star of a point, at its position in `mesh`, and the gradient there. `lanes` as load_star left them.
    double star(const MovingMesh &mesh, std::int32_t point, std::vector<energy::TetLanes> &lanes, Vec3 &gradient,
                std::size_t &work) const;

  private:
    void load_terms(const MovingMesh &mesh, std::span<const std::int32_t> tets, energy::TermLanes &terms) const;

    energy::EnergyForm form_;
    Emphasis emphasis_;
};

/// The star of a point, the point being corner 0 of each tet; spare lanes repeat the last tet. `lanes` grows as needed.
void load_star(const MovingMesh &mesh, std::int32_t point, std::vector<energy::TetLanes> &lanes);

} // namespace wct::move_vertices
