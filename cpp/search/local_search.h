#pragma once

#include "search/kicks.h"
#include "search/search_options.h"
#include "search/sweeps.h"

#include <functional>
#include <vector>

namespace wct::search {

class SurfaceBalance;

struct SearchOutcome {
    int bad = 0;
    std::vector<int> stuck; // the bad tets of the complex once the search has ended, but for those that are ruled out
    int passes = 0;
    long kicks = 0;
    long accepted = 0;
    long evaluations = 0;
    long work = 0; // as of WorkUnits
    bool stopped = false;
};

/// Called now and then with the part done (of the present phase) and the number of bad tets; false stops the search.
using SearchProgress = std::function<bool(const char *phase, double done, int bad)>;

/// Makes a mesh well-centered by local changes: passes over the tets that fall short, each trying operators and keeping
/// what lowers the energy; then iterated local search (Lourenço, Martin, Stützle 2003) at what is left: kick a
/// neighbourhood, optimise it again, keep the result unless it got worse; then the same for the margins. Bad
/// tets never increase from phase to phase, and every intermediate state is a valid mesh.
class LocalSearch {
  public:
    LocalSearch(TetComplex &complex, const SurfaceGuide &guide, const SearchOptions &options);

    SearchOutcome run(const SearchProgress &progress);

  private:
    void adopt(const SearchForm &form);
    /// Those that miss the goal, or are at a facet beyond the tolerance.
    std::vector<int> bad_tets() const;
    long work() const { return crew_.spent().work(); }
    int count_bad() const { return static_cast<int>(bad_tets().size()); }
    void sweep(int recipe);
    /// How many kicks in vain to bear with this many bad tets left, and in a hurry.
    long patience(int bad) const;
    long hurried(int bad) const;
    /// What kicks have cost and brought lately; old ones count less and less.
    struct Price {
        double spent = 0.0; // evaluations, all of them
        double work = 0.0;  // of late
        double gone = 0.0;  // bad tets, of late
        void add(double evaluations, int fewer);
    };
    bool worthwhile(const Price &price, int bad) const;
    /// Kick until no tet is bad, or as long as it pays; `bearable` is how many kicks in vain to bear for the number of
    /// bad tets left.
    bool kick_until_good(const SearchProgress &progress, const char *phase, const std::function<long(int)> &bearable);
    /// Where all tets meet the goal: more clearance for those that do so narrowly, and none the worse for it.
    void widen_margins(const SearchProgress &progress);
    /// Where volumes or areas are missed after the balance, as no vertex may move without making a tet bad: they are
    /// moved all the same, and the tets mended, if that comes to good.
    void keep_by_force(SurfaceBalance &balance, const SearchProgress &progress,
                       const std::function<long(int)> &bearable);

    TetComplex &complex_;
    const SurfaceGuide &guide_;
    SearchOptions options_;
    Random random_;
    Workbench bench_;
    Crew crew_;
    Sweeps sweeps_;
    Kicks kicks_;
    SearchOutcome outcome_;
};

} // namespace wct::search
