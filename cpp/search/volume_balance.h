#pragma once

#include "search/surface_guide.h"
#include "search/tet_complex.h"
#include "search/vertex_descent.h"

#include <vector>

namespace wct::search {

/// Shifts the vertices of curved patches until the facets lie as much before a patch as behind it, so that the regions
/// on both sides keep their volumes. Vertices stay where that would make a tet bad or leave the tolerance.
class SurfaceBalance {
  public:
    SurfaceBalance(TetComplex &complex, const SearchEnergy &energy, const SurfaceGuide &guide, StarDescent &descent)
        : complex_(complex), energy_(energy), guide_(guide), descent_(descent) {}

    void run();

  private:
    /// Mean signed distance of the facets from each curved patch, in front of its triangles positive.
    std::vector<double> offsets();
    bool shift(int v, double by);
    /// Tets at v that are short of the margin asked for, and those of them that miss the goal itself.
    struct Short {
        int of_margin = 0, of_goal = 0;
    };
    Short short_around(int v) const;

    TetComplex &complex_;
    const SearchEnergy &energy_;
    const SurfaceGuide &guide_;
    StarDescent &descent_;
};

} // namespace wct::search
