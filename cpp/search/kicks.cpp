#include "search/kicks.h"

#include <algorithm>
#include <array>
#include <atomic>

namespace wct::search {

namespace {
constexpr std::size_t kBatch = 16;
constexpr double kNear = 5.0;  // in sizes: of kicks so near each other hardly two would be kept
constexpr double kFewer = 0.1; // what a bad tet less lowers the energy by at least
} // namespace

void Kicks::restart() {
    queue_.rebuild();
    tasks_.clear();
    next_ = 0;
    constexpr std::size_t each = 4; // kicks that a bad tet takes at least, roughly
    crew_.gather(each * static_cast<std::size_t>(bad()));
}

void Kicks::choose() {
    const TetComplex &mesh = crew_.mesh();
    tasks_.clear();
    std::vector<int> turns; // by place
    for (std::size_t k = 0; k < kBatch; ++k) {
        const int t = queue_.next();
        Task task{t, queue_.failures(t), random_.next(), mesh.centroid(t), mesh.vertex(mesh.tet(t)[0]).size};
        const auto near = [&](const Task &other) {
            return norm(other.center - task.center) < kNear * std::max(other.size, task.size);
        };
        const auto first = std::ranges::find_if(tasks_, near);
        task.place = first == tasks_.end() ? turns.size() : first->place;
        turns.resize(std::max(turns.size(), task.place + 1), 0);
        task.turn = turns[task.place]++;
        tasks_.push_back(task);
        queue_.failed(t); // until it is known
    }
    // Once at each place first: while others are tried it gets known what that has come to.
    std::ranges::stable_sort(tasks_, {}, &Task::turn);
}

void Kicks::try_all() {
    std::array<std::atomic<std::size_t>, kBatch> first; // by place: of the tasks there that are fit to be kept
    for (auto &one : first)
        one = kBatch;
    attempts_.assign(tasks_.size(), {});
    crew_.run(attempts_, [&](Workbench &bench, std::size_t k) {
        const Task &task = tasks_[k];
        if (first[task.place] < k) // it will be passed over
            return Attempt{};
        Attempt made = bench.attempt(
            task.seed, [&] { return bench.kick.at(task.tet, task.failures) && (!allowed || allowed(bench)); });
        if (std::size_t least = first[task.place]; made.change)
            while (k < least && !first[task.place].compare_exchange_weak(least, k)) {
            }
        return made;
    });
    kept_.assign(tasks_.size(), 0);
    any_kept_ = false;
    next_ = 0;
}

bool Kicks::counts(std::size_t k) const {
    return !kept_[tasks_[k].place] && !(allowed && any_kept_) && !crew_.reached(tasks_[k].tet, attempts_[k]);
}

void Kicks::advance() {
    for (;; ++next_) {
        if (next_ == tasks_.size()) {
            choose();
            try_all();
        }
        if (counts(next_))
            return;
        kept_[tasks_[next_].place] |= attempts_[next_].change.has_value();
        queue_.not_tried(tasks_[next_].tet);
    }
}

bool Kicks::tried() {
    advance();
    return tasks_[next_].failures >= Kick::tried;
}

void Kicks::keep(std::size_t k, bool better) {
    const Task &task = tasks_[k];
    any_kept_ = true;
    queue_.update(crew_.keep(*attempts_[k].change), better ? task.failures / 2 : task.failures + 1);
    if (better)
        queue_.not_tried(task.tet);
}

Kicks::Outcome Kicks::once() {
    advance();
    const std::size_t k = next_++;
    const Attempt &made = attempts_[k];
    crew_.count(made);
    const bool keeps = made.change && crew_.has_room(*made.change);
    const bool better = keeps && made.gain < -kFewer;
    kept_[tasks_[k].place] |= made.change.has_value();
    if (keeps)
        keep(k, better);
    return {better, made.spent.evaluations};
}

} // namespace wct::search
