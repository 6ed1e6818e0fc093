#pragma once

#include "search/repair.h"

#include <optional>
#include <vector>

namespace wct::search {

/// A step of iterated local search (Lourenço, Martin, Stützle 2003) at a tet that misses the goal: kick its
/// neighbourhood, repair it, keep the result unless it got worse, or not much worse where all else has failed (their
/// acceptance between "better" and "random walk"): places that held out for a thousand kicks come right so in some
/// hundred. Kicks are small: of hundreds that reached farther, at places where nothing else had helped either, one in
/// five hundred brought anything, at three times the cost.
class Kick {
  public:
    Kick(TetComplex &complex, const SearchEnergy &energy, Operators &operators, VertexDescent &descent,
         SurfaceWatch &watch, Repair &repair, Random &random)
        : complex_(complex), energy_(energy), operators_(operators), descent_(descent), watch_(watch), repair_(repair),
          random_(random) {}

    /// Failures at a tet from which on kicks there may leave the mesh worse.
    static constexpr int tried = 20;
    /// Kick at t, where so many kicks have failed; whether what it has come to, since the mark set before, may stay.
    bool at(int t, int failures);

  private:
    struct Strength {
        double radius, sigma; // in local sizes
        int operators;
        double slack;
    };
    void ball(const Vec3 &center, double radius, int vertex, std::vector<int> &out);
    /// Two creases that meet in a corner at a right or obtuse angle span no acute facet: split every edge at the
    /// corners of t that closes such a facet. Chance finds this seldom, since all wedges of a corner must open at once.
    void open_wedges(int t);
    /// Four facets round a vertex of a patch are not all acute unless it stands out like a tip, and the tolerance may
    /// not let it: flip an edge opposite to it, or do away with it. On the way facets may leave the tolerance.
    void mend_valence(int t);
    /// A facet beyond the tolerance is too large for its place, and so may one be that will not get acute: give the
    /// surface a vertex there at any price, and more where the facets round that are still beyond the tolerance. Chance
    /// seldom finds the facet among those of the neighbourhood, and a vertex more that is not relaxed yet costs more
    /// than the slack of a random operator.
    void refine_surface(int t);
    /// The facet at v that is farthest beyond the tolerance, if one is.
    std::optional<Facet> worst_facet(int v);
    /// `refine` is the chance that the surface is refined.
    void shake(int t, const Strength &kick, double refine);
    /// Into changed_: the tets nearest to the center that the kick changed and that fall short. What it left as it was
    /// has been tried before.
    void near_changed(const Vec3 &center, double radius);
    /// Whether the mesh has got better, or worse by less than that.
    bool repair(const Vec3 &center, double radius, double worse);

    TetComplex &complex_;
    const SearchEnergy &energy_;
    Operators &operators_;
    VertexDescent &descent_;
    SurfaceWatch &watch_;
    Repair &repair_;
    Random &random_;
    std::vector<TetComplex::SurfaceAt> facets_;
    std::vector<int> marks_;
    int mark_ = 0;
    std::vector<int> changed_;
    std::vector<std::pair<double, int>> nearest_;
};

} // namespace wct::search
