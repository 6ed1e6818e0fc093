#pragma once

#include "operators.h"

namespace wct {

/// Moves single vertices downhill: BFGS in the three coordinates of one vertex, on the energy of its star. No tet
/// inverts; a surface vertex stays on its stratum, and no facet of it leaves the tolerance (or, where it was outside
/// already, moves further out).
class StarDescent {
  public:
    StarDescent(TetComplex &complex, const SearchEnergy &energy, const SurfaceGuide &guide, const Operators &operators)
        : complex_(complex), energy_(energy), guide_(guide), operators_(operators) {}

    /// At most `steps` quasi-Newton steps; true if the vertex moved (journaled).
    bool relax(int v, int steps);
    /// Move v to x, or part of the way there, if that leaves no tet flat and the surface in tolerance.
    bool nudge(int v, const Vec3 &x);
    /// False for vertices that may not move.
    bool movable(int v) const { return complex_.vertex(v).stratum != Stratum::corner; }

  private:
    void gather_facets(int v);
    bool facets_allow(int v, const Vec3 &x);
    void settle(int v, const Vec3 &x);

    TetComplex &complex_;
    const SearchEnergy &energy_;
    const SurfaceGuide &guide_;
    const Operators &operators_;
    StarLanes star_;
    std::vector<double> energies_;
    struct Held { // a surface facet at the vertex, and how far it may be from its patch
        Facet facet;
        int patch;
        double limit;
        SurfaceGuide::Hints hints;
    };
    std::vector<Held> held_;
    std::vector<Facet> facets_;
    std::vector<int> patches_;
};

} // namespace wct
