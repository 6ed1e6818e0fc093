#pragma once

#include "search/workbench.h"

#include <algorithm>
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
    /// attempts[k] = tried(bench, k) for each of them, on any thread.
    template <class Try> void run(std::vector<Attempt> &attempts, const Try &tried);
    /// Do the change to all copies; `changed`: tets added, removed or measured anew.
    void apply(const MeshChange &change, std::vector<int> &changed);
    /// Recompute the sum of energies, as of TetComplex.
    void resum();
    /// Whether as many tets more may come.
    bool has_room(const MeshChange &change) const {
        return change.growth() <= 0 ||
               static_cast<std::size_t>(change.growth()) <= options_.most - std::min(options_.most, mesh().tets());
    }

    const TetComplex &mesh() const { return own_.complex; }
    Workbench &own() { return own_; }
    const Workbench &own() const { return own_; }
    /// What was spent on attempts on the mesh itself, rather than a copy.
    const Spent &spent() const { return spent_; }

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
    Spent spent_;
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
    const Workers workers(static_cast<unsigned>(idle.size()));
    const Spent before = own_.spent();
    workers.for_each(attempts.size(), 1, [&](std::size_t k) {
        const std::unique_ptr<Workbench, decltype(give_back)> bench(take(), give_back);
        attempts[k] = tried(*bench, k);
    });
    spent_ += own_.spent() - before;
}

} // namespace wct::search
