#pragma once

#include "energy/energy.h"
#include "search/tet_complex.h"

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

namespace wct::search {

/// What the search minimises: the smooth penalties, a term against needle-like angles (without it, edges clump when
/// only h/R is penalised), and a count of the tets that miss the goal by less than `clearance`.
struct SearchForm {
    energy::EnergyForm shape;
    double needle_weight = 100.0; // see Vertex::needle
    double count = 0.05;
    /// Exact right angles (cos about 1e-17) must not pass for acute.
    double clearance = 2e-3;
    /// For each tet below `hard_clearance`, where that differs: margins are not bought with tets that miss the goal.
    double hard_count = 0.0;
    double hard_clearance = 2e-3;
    /// For each surface facet of the tet that is beyond the tolerance, times 1 + how far in tolerances.
    double over_weight = 0.5;
};

/// What the energies of tets in lanes depend on besides their shapes.
struct SearchTerms {
    energy::TermLanes bounds;
    energy::Lanes needle; // cosine above which an angle is one
};

/// A vertex star in lanes, the vertex as corner 0 of every tet: only that corner changes while the vertex moves.
struct StarLanes {
    std::vector<energy::TetLanes> lanes;
    std::vector<SearchTerms> terms;
    std::vector<int> tets; // worst first: then most of what goes too far is seen at once

    /// Tets in a group of lanes: the last may have fewer.
    int used(std::size_t group) const {
        return static_cast<int>(std::min<std::size_t>(energy::kLanes, tets.size() - group * energy::kLanes));
    }
};

class SearchEnergy {
  public:
    explicit SearchEnergy(const SearchForm &form) : form_(form) {}

    const SearchForm &form() const { return form_; }
    void adopt(const SearchForm &form) { form_ = form; }
    /// Energy at or above which a tet misses the goal: the count term is in it.
    bool bad(double energy) const { return energy >= form_.count; }
    /// The same where the form also counts tets that are only short of a margin.
    bool misses_goal(double energy) const { return energy >= form_.count + form_.hard_count; }

    /// Energies of tets on the complex's vertices; infinite where flat or inverted.
    void of(const TetComplex &complex, std::span<const Tet> tets, double *energies) const;
    /// Whether the tet is not inverted: cheap, and most of what an operator would make fails here.
    static bool positive(const TetComplex &complex, const Tet &tet);
    /// Whether the energies' sum is below `limit`; if not, they are not all written.
    bool below(const TetComplex &complex, std::span<const Tet> tets, double limit, double *energies) const;
    /// The same for tets that exist already: finite however flat they are, as long as they are not inverted.
    void of_present(const TetComplex &complex, std::span<const Tet> tets, double *energies) const;
    double of_present(const TetComplex &complex, const Tet &tet) const;

    /// Bounds for tets that exist already: one that came in flatter than allowed must not hold its vertices for ever,
    /// so it may stay as flat as it is.
    static energy::TermLanes present_bounds(const energy::TetLanes &tets);
    /// Of a tet's vertices the one that allows the sharpest angles decides.
    static double needle(const TetComplex &complex, const Tet &tet);
    void gather(const TetComplex &complex, int v, StarLanes &star) const;
    double over(const TetComplex &complex, const Tet &tet) const { return form_.over_weight * complex.over(tet); }
    /// Sum of the smooth part (no count) over the star with its vertex at x; gradient with respect to x. Infinite where
    /// the sum is above `limit`: then the rest of the star, and the gradient, are not looked at.
    double at(StarLanes &star, const Vec3 &x, Vec3 *gradient,
              double limit = std::numeric_limits<double>::infinity()) const;
    /// Energies (with count) of the star's tets with its vertex at x, in the order of star.tets.
    void each(StarLanes &star, const Vec3 &x, double *energies) const;

    /// Sum of the first `used` energies in a smooth form, for vertices that move together: quadratic penalties, no
    /// count. The gradient at all corners is written where that is above zero (with no energy there is no slope) and no
    /// more than `limit`.
    double smooth(const energy::TetLanes &tets, const SearchTerms &terms, int used, double limit,
                  energy::GradientLanes &gradient) const;

    /// Tet energies (and gradients) evaluated so far.
    long evaluations() const { return evaluations_; }

  private:
    void of(const TetComplex &complex, std::span<const Tet> tets, double flattest, double *energies) const;
    /// False, and no gradient, where the first `used` energies come to more than `limit`.
    bool evaluate(const energy::TetLanes &tets, const SearchTerms &terms, energy::Lanes &energy,
                  energy::Lanes *gradient, bool count, int used = energy::kLanes,
                  double limit = std::numeric_limits<double>::infinity()) const;

    SearchForm form_;
    mutable long evaluations_ = 0;
};

} // namespace wct::search
