#pragma once

#include "search/bad_tet_queue.h"
#include "search/crew.h"

#include <functional>
#include <vector>

namespace wct::search {

/// Kicks at the bad tets of a mesh, those tried least first.
///
/// A few are tried at a time, from the same mesh, on as many threads as there are. What they come to is kept in their
/// order, unless it reaches what was kept before it: then it counts for nothing, as if it had not been tried. So at
/// places apart several kicks are kept at a time, and where kicks are at one place the others were tried in case the
/// ones before would fail.
class Kicks {
  public:
    Kicks(Crew &crew, Random &random) : crew_(crew), random_(random), queue_(crew.mesh(), crew.own().energy, random) {}

    /// Look for bad tets afresh, after changes made elsewhere.
    void restart();
    int bad() const { return queue_.bad(); }
    /// Whether the kick that comes next, there must be a bad tet, may leave the mesh worse: so often has its tet been
    /// tried.
    bool tried();
    struct Outcome {
        bool better = false; // by a bad tet
        long evaluations = 0;
    };
    /// The next kick; there must be a bad tet.
    Outcome once();
    /// Whether what a kick has come to, on a bench, may stay; empty: any. Then no more than one of those tried at a
    /// time is kept.
    std::function<bool(Workbench &)> allowed;

  private:
    struct Task {
        int tet;
        int failures;
        std::uint64_t seed;
        Vec3 center;
        double size;
        std::size_t place = 0; // of a number of tasks near each other
        int turn = 0;          // among those
    };
    void choose();
    void try_all();
    /// Go on to a task that nothing kept reaches.
    void advance();
    bool counts(std::size_t k) const;
    void keep(std::size_t k, bool better);

    Crew &crew_;
    Random &random_;
    BadTetQueue queue_;
    std::vector<Task> tasks_;
    std::vector<Attempt> attempts_; // of the tasks
    std::size_t next_ = 0;          // task
    std::vector<char> kept_;        // by place, whether one of those before was fit to be kept there
    bool any_kept_ = false;
};

} // namespace wct::search
