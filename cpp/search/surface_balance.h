#pragma once

#include "search/surface_guide.h"
#include "search/tet_complex.h"
#include "search/vertex_descent.h"

#include <map>
#include <span>
#include <vector>

namespace wct::search {

/// Shifts vertices of curved patches until the facets lie as much before a patch as behind it; then those of the curved
/// rims of planes, in the plane, until these have their area; then curved patches again, until regions have their
/// volume; and where there are curved patches inside, all that have a measure to keep at once. Vertices stay where that
/// would make a tet bad or leave the tolerance.
class SurfaceBalance {
  public:
    /// `volumes` that the regions are to have, by number; empty: any.
    SurfaceBalance(TetComplex &complex, const SearchEnergy &energy, const SurfaceGuide &guide, VertexDescent &descent,
                   std::span<const double> volumes)
        : complex_(complex), energy_(energy), guide_(guide), descent_(descent), volumes_(volumes) {}

    void run();
    /// Only what planes with curved rims miss of their areas, where that is much: while nothing but the goal itself is
    /// asked for, more vertices can move.
    void keep_areas_roughly() { keep_areas(kMuch); }
    /// Which patches have an area to keep: planes with curved rims, and curved ones inside.
    std::vector<char> kept_patches() const;
    /// What volumes of regions and areas of these patches still miss beyond what is borne, in shares of each, summed.
    double missed(const std::vector<char> &kept) const;
    /// Give them what they miss where the tolerance allows, whatever tets that makes bad: they are to be mended.
    void force(const std::vector<char> &kept) { keep_measures(kept, true); }

  private:
    static constexpr double kMuch = 1e-3; // of an area: for more than that the mesh beside makes room
    static constexpr double kKept = 1e-4; // of an area or volume
    /// The same of what cannot all be exact, as the area and the volume in a coarse sphere, and what is aimed at then.
    static constexpr double kBorne = 4.5e-3, kAimed = 2.5e-3;

    /// Each vertex of a curved patch half-way to the mean height of its neighbours, as none is higher for the surface's
    /// sake.
    void smooth();
    /// The facets of a patch as far before it as behind, in the mean.
    void even_out();
    /// To this share of each.
    void keep_areas(double share);
    /// Per patch what it misses of its area.
    std::vector<double> missing_areas() const;
    /// Per region what it misses of its volume.
    std::vector<double> missing_volumes() const;
    /// Per planar patch the vertices of its curved creases.
    std::vector<std::vector<int>> curved_rims() const;
    void keep_volumes();
    struct Measure;
    /// The areas of these patches and the volumes of all regions, yet without gradients.
    std::vector<Measure> measures(const std::vector<char> &kept) const;
    void add_gradients(const std::vector<char> &kept, std::vector<Measure> &all) const;
    static std::map<int, Vec3> steps_for(const std::vector<Measure> &measures);
    /// All of them at once; `forced`: whatever tets that makes bad.
    void keep_measures(const std::vector<char> &kept, bool forced);
    /// Mean signed distance of the facets from each curved patch, in front of its triangles positive.
    std::vector<double> offsets();
    /// Move v to x, if nothing speaks against it.
    bool move(int v, const Vec3 &x);
    /// The same, where vertices beside it may make room for it, other than those of creases.
    bool move_with_room(int v, const Vec3 &x);
    /// Let those beside v descend; true if any moved.
    bool relax_beside(int v);
    bool shift(int v, double by);
    bool shift_patches(const std::vector<double> &by);
    /// How the area of a planar patch changes when v, on its rim, moves in its plane.
    Vec3 area_gradient(int v, int patch) const;
    /// Of some tets, those that are short of the margin asked for, and those of them that miss the goal itself.
    struct Short {
        int of_margin = 0, of_goal = 0;
        bool fewer_than(const Short &other) const { return of_margin < other.of_margin || of_goal < other.of_goal; }
    };
    Short count_short(std::span<const int> tets) const;
    /// The tets at v and at its neighbours.
    std::vector<int> tets_near(int v) const;

    TetComplex &complex_;
    const SearchEnergy &energy_;
    const SurfaceGuide &guide_;
    VertexDescent &descent_;
    std::span<const double> volumes_;
};

} // namespace wct::search
