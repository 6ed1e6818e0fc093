#pragma once

#include "base/parallel.h"
#include "energy/energy.h"
#include "sampling/cloud.h"
#include "sampling/restricted_delaunay.h"
#include "sampling/surface_fit.h"

#include <vector>

namespace wct::sampling {

/// How many tets miss well-centeredness, and how badly.
struct Tally {
    std::size_t tets = 0;
    std::size_t bad = 0;
    double worst_height = 1.0;
};
Tally count_bad(const Cloud &cloud, const RestrictedDelaunay &complex, bool cosines);

/// A penalty on surface edges that are too long for the tolerance: weight * sum max(0, length / reach - 1)^2.
struct EdgeForm {
    double weight = 2.0;
    static constexpr double limit = 1.2; // in target sizes
};

/// The points of the surface and of tets short of the energy's margins, and those so many rings of tets round them: the
/// others are where they should be, but for the small part that makes tets regular.
std::vector<char> points_to_move(const Cloud &cloud, const RestrictedDelaunay &complex, energy::EnergyForm form,
                                 int rings);

/// How far a descent goes: so many steps, none longer than `reach` times a point's size.
struct Course {
    int iterations;
    double reach;
};

/// Lower the energy of all tets at once by L-BFGS, keeping the connectivity. Patch points move in the plane across
/// `direction`, crease points along it, corners not at all; `curved` marks the points of curved patches and creases.
/// Tets whose points nothing moves are not looked at, those between points that relaxation holds count more. Returns
/// the number of tet evaluations.
std::size_t descend(Cloud &cloud, const RestrictedDelaunay &complex, const std::vector<Vec3> &direction,
                    const energy::EnergyForm &form, const EdgeForm &edges, const std::vector<char> &curved,
                    const FitForm &fit, const std::vector<Tie> &ties, const Course &course, const Workers &workers);

} // namespace wct::sampling
