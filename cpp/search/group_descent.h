#pragma once

#include "energy/lbfgs.h"
#include "search/search_energy.h"
#include "search/surface_watch.h"

#include <vector>

namespace wct::search {

/// Moves the vertices of a neighbourhood downhill together, by L-BFGS (Nocedal 1980) on a smooth form of the energy.
/// One by one they jam where two tets pull a vertex both ways, although the two could give way together.
class GroupDescent {
  public:
    GroupDescent(TetComplex &complex, const SearchEnergy &energy, const SurfaceGuide &guide, SurfaceWatch &watch)
        : complex_(complex), energy_(energy), guide_(guide), watch_(watch) {}

    /// Move the vertices of t and of all tets at them, by a few steps; true if they moved (journaled). No tet inverts.
    /// Vertices of a curved surface move along it; those that would take a facet out of the tolerance stay where they
    /// are.
    bool relax_round(int t);

  private:
    class Moving;
    void gather(int t);
    void load();
    void hold();
    void place(const energy::Field &from, double t, const energy::Field &step, energy::Field &to);
    double evaluate(const energy::Field &at, double limit, energy::Field &gradient);
    bool settle(const energy::Field &at);

    TetComplex &complex_;
    const SearchEnergy &energy_;
    const SurfaceGuide &guide_;
    SurfaceWatch &watch_;
    std::vector<int> free_;    // vertices that move
    std::vector<int> tets_;    // tets at them
    std::vector<int> number_;  // per vertex: its place in free_, -1 between calls
    std::vector<Tet> corners_; // per tet: places in free_, -1 for corners that stay
    std::vector<energy::TetLanes> lanes_;
    std::vector<SearchTerms> terms_;
    std::vector<std::int32_t> hints_; // per free vertex: where the surface was found
    std::vector<Freedom> freedoms_;
    std::vector<Tet> measured_;
    std::vector<double> energies_;
};

} // namespace wct::search
