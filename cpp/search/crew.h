#pragma once

#include "search/workbench.h"

#include <memory>
#include <mutex>
#include <vector>

namespace wct::search {

/// Several threads that try changes of one mesh at places apart from each other, each on a copy of its own.
///
/// What is tried starts from the same mesh, whichever thread tries it, and what is kept is done to all copies in the
/// same order: so the mesh comes out the same bits whatever the number of threads.
class Crew {
  public:
    Crew(Workbench &own, const SurfaceGuide &guide, const SearchOptions &options)
        : own_(own), guide_(guide), options_(options) {}

    /// The mesh, which nothing but `apply` may change from now on, will be tried to change about so many times.
    void gather(std::size_t tries);
    /// A batch: attempts[k] = tried(bench, k) for each of them, on any thread.
    template <class Try> void run(std::vector<Attempt> &attempts, const Try &tried);
    /// Whether what was kept of this batch changed anything at the tet tried, or at what came of it.
    bool reached(int tet, const Attempt &attempt) const;
    /// Whether as many tets more may come.
    bool has_room(const MeshChange &change) const {
        return own_.operators.has_room(change.gone_tets.size(), change.tets.size());
    }
    /// Keep the change: do it to all copies. Returns the tets added, removed or measured anew.
    std::vector<int> keep(const MeshChange &change);
    /// The attempt counts, and so does what it took.
    void count(const Attempt &attempt) { spent_ += attempt.spent; }
    /// Recompute the sum of energies, as of TetComplex.
    void resum();

    const TetComplex &mesh() const { return own_.complex; }
    const Workbench &own() const { return own_; }
    /// All that counts, as it would be spent by one thread.
    Spent spent() const {
        Spent sum = own_.spent();
        return sum += spent_;
    }

  private:
    struct Helper {
        Helper(const Crew &crew)
            : copy(crew.own_.complex),
              bench(copy, crew.guide_, crew.own_.energy.form(), crew.options_, crew.own_.watch.divides_corners) {}
        TetComplex copy;
        Workbench bench;
    };

    Workbench &own_;
    const SurfaceGuide &guide_;
    const SearchOptions &options_;
    std::vector<std::unique_ptr<Helper>> helpers_;
    Spent spent_; // on attempts that count, less all those on the mesh itself
    int batch_ = 0;
    std::vector<int> claims_; // by vertex: the last batch of which something was kept that touched it
};

template <class Try> void Crew::run(std::vector<Attempt> &attempts, const Try &tried) {
    std::vector<Workbench *> idle{&own_};
    for (const auto &helper : helpers_)
        idle.push_back(&helper->bench);
    std::mutex guard;
    const auto take = [&] {
        const std::lock_guard lock(guard);
        Workbench *bench = idle.back();
        idle.pop_back();
        return bench;
    };
    const auto give_back = [&](Workbench *bench) {
        const std::lock_guard lock(guard);
        idle.push_back(bench);
    };
    ++batch_;
    const Workers workers(static_cast<unsigned>(idle.size()));
    const Spent before = own_.spent();
    workers.for_each(attempts.size(), 1, [&](std::size_t k) {
        const std::unique_ptr<Workbench, decltype(give_back)> bench(take(), give_back);
        attempts[k] = tried(*bench, k);
    });
    spent_ += before - own_.spent();
}

} // namespace wct::search
