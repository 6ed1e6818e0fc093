#pragma once

#include "search/crew.h"

#include <vector>

namespace wct::search {

/// Sweeps over the tets that fall short, worst first, each repaired by one of Repair's recipes.
///
/// Those far enough apart are repaired at the same time, from the same mesh. What one comes to is kept unless it
/// reaches what was kept before it: then its turn comes again.
class Sweeps {
  public:
    Sweeps(Crew &crew, Random &random) : crew_(crew), random_(random) {}

    /// Tets tried in vain by this recipe before are left out until something changes round them.
    void run(int recipe, std::vector<int> tets);

  private:
    bool falls_short(int t) const;
    bool changed_since(int t, int when) const;
    /// Into batch_: the next in order_ that are apart; the others stay.
    void choose();
    void try_all(int recipe);
    void keep_all();

    Crew &crew_;
    Random &random_;
    std::vector<int> order_; // tets to come, the next last
    std::vector<int> batch_;
    std::vector<Attempt> attempts_; // at those of the batch
    int clock_ = 0;
    std::vector<int> changed_at_;  // by tet
    std::vector<int> tried_at_[3]; // by tet, for each recipe
};

} // namespace wct::search
