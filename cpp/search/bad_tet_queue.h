#pragma once

#include "base/random.h"
#include "search/search_energy.h"

#include <cstdint>
#include <queue>
#include <tuple>
#include <vector>

namespace wct::search {

/// The bad tets, but for those on facets that rule the goal out, and how often each was tried in vain. The one tried
/// least comes next, so that hopeless places never keep the others waiting; equals come in random order. Kept up to
/// date from what changed, never by a scan.
class BadTetQueue {
  public:
    BadTetQueue(const TetComplex &complex, const SearchEnergy &energy, Random &random)
        : complex_(complex), energy_(energy), random_(random) {}

    /// Forget everything and look through all tets.
    void rebuild();
    /// How many bad tets there are.
    int bad() const { return bad_; }
    /// A bad tet tried least so far; there must be one.
    int next();
    int failures(int t) const { return entries_[t].failures; }
    /// Note a try in vain at t; its place in the queue moves back.
    void failed(int t);
    /// What was noted as a try in vain was none.
    void not_tried(int t);
    /// These tets may have become good or bad, come or gone. New bad ones count as tried `failures` times.
    void update(const std::vector<int> &changed, int failures);

  private:
    struct Entry {
        int failures = 0;
        bool bad = false;
        std::uint32_t ticket = 0; // of its valid place in the queue
    };
    using Place = std::tuple<int, std::uint32_t, int>; // failures, ticket, tet
    void enqueue(int t);

    const TetComplex &complex_;
    const SearchEnergy &energy_;
    Random &random_;
    std::vector<Entry> entries_; // by tet
    std::priority_queue<Place, std::vector<Place>, std::greater<>> queue_;
    int bad_ = 0;
};

} // namespace wct::search
