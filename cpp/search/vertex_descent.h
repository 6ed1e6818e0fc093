#pragma once

#include "search/search_energy.h"
#include "search/surface_watch.h"

namespace wct::search {

/// Moves single vertices downhill: BFGS in the three coordinates of one vertex, on the energy of its star. No tet
/// inverts; a surface vertex stays on its stratum, and no facet of it leaves the tolerance (or, where it was outside
/// already, moves further out).
class StarDescent {
  public:
    StarDescent(TetComplex &complex, const SearchEnergy &energy, const SurfaceGuide &guide, SurfaceWatch &watch)
        : complex_(complex), energy_(energy), guide_(guide), watch_(watch) {}

    /// At most `steps` quasi-Newton steps; true if the vertex moved (journaled).
    bool relax(int v, int steps);
    /// Move v to x, or part of the way there, if that leaves no tet flat and the surface in tolerance.
    bool nudge(int v, const Vec3 &x);
    /// False for vertices that may not move.
    bool movable(int v) const { return guide_.moves(complex_.vertex(v)); }

  private:
    bool settle(int v, const Vec3 &x);

    TetComplex &complex_;
    const SearchEnergy &energy_;
    const SurfaceGuide &guide_;
    SurfaceWatch &watch_;
    StarLanes star_;
    std::vector<double> energies_;
};

} // namespace wct::search
