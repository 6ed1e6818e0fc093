#pragma once

#include "search/search_energy.h"
#include "search/surface_watch.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace wct::search {

/// Moves single vertices downhill: BFGS in the three coordinates of one vertex, on the energy of its star. No tet
/// inverts; a surface vertex stays on its stratum, and no facet of it leaves the tolerance (or, where it was outside
/// already, moves further out).
class VertexDescent {
  public:
    VertexDescent(TetComplex &complex, const SearchEnergy &energy, const SurfaceGuide &guide, SurfaceWatch &watch)
        : complex_(complex), energy_(energy), guide_(guide), watch_(watch) {}

    /// At most `steps` quasi-Newton steps; true if the vertex moved (journaled).
    bool relax(int v, int steps);
    /// Move v to x, or part of the way there, if that leaves no tet flat and the surface in tolerance.
    bool nudge(int v, const Vec3 &x);
    /// False for vertices that may not move.
    bool movable(int v) const { return guide_.moves(complex_.vertex(v)); }

  private:
    /// Somewhere the vertex may be, with what its star costs there, how that changes, and how it may go on.
    struct Place {
        Vec3 x, gradient;
        double energy = std::numeric_limits<double>::infinity();
        Freedom freedom;
    };
    /// Mean distance to the neighbours, each as often as tets share it.
    double neighbour_distance(int v) const;
    /// Add what facets beyond the tolerance cost at the place that the watch was asked about last.
    void add_watched(Place &place) const;
    /// Gather the star and evaluate the place where v is; false if there is nothing to gain, or v may not move.
    bool start(int v, std::int32_t &hint, Place &place);
    /// Turn a step that the tolerance refuses along the surface; false, and nothing turned, where that would hardly
    /// lead down.
    bool slide(const Vec3 &gradient, Vec3 &d, double &slope) const;
    /// Find the place `to` along d that is lower by enough, and that tets and surface allow; `length` is the mean
    /// distance to the neighbours. False if d does not lead down, or no place was found.
    bool step_down(const Vertex &vertex, const Place &from, Vec3 d, double length, std::int32_t &hint, Place &to);
    /// Move v to x if the surface allows, and measure its tets there.
    bool settle(int v, const Vec3 &x);

    TetComplex &complex_;
    const SearchEnergy &energy_;
    const SurfaceGuide &guide_;
    SurfaceWatch &watch_;
    StarLanes star_;
    std::vector<double> energies_;
};

} // namespace wct::search
