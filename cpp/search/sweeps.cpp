#include "search/sweeps.h"

#include <algorithm>

namespace wct::search {

namespace {
constexpr std::size_t kBatch = 16;
constexpr std::size_t kWindow = 64; // tets among which those of a batch are looked for
constexpr double kApart = 4.0;      // in sizes: what is tried so far apart seldom reaches the other
} // namespace

bool Sweeps::falls_short(int t) const {
    return crew_.mesh().alive(t) && crew_.own().energy.bad(crew_.mesh().energy(t));
}

bool Sweeps::changed_since(int t, int when) const {
    const TetComplex &mesh = crew_.mesh();
    for (int v : mesh.tet(t))
        for (int s : mesh.star(v))
            if (changed_at_[s] > when)
                return true;
    return false;
}

void Sweeps::choose() {
    const TetComplex &mesh = crew_.mesh();
    batch_.clear();
    std::vector<int> later;
    for (std::size_t k = 0; k < kWindow && batch_.size() < kBatch && !order_.empty(); ++k) {
        const int t = order_.back();
        order_.pop_back();
        if (!falls_short(t))
            continue; // gone or good by now
        const Vec3 center = mesh.centroid(t);
        const auto near = [&](int s) {
            return norm(mesh.centroid(s) - center) < kApart * mesh.vertex(mesh.tet(t)[0]).size;
        };
        (std::ranges::none_of(batch_, near) ? batch_ : later).push_back(t);
    }
    order_.insert(order_.end(), later.rbegin(), later.rend());
}

void Sweeps::try_all(int recipe) {
    std::vector<std::uint64_t> seeds;
    for (std::size_t k = 0; k < batch_.size(); ++k)
        seeds.push_back(random_.next());
    attempts_.assign(batch_.size(), {});
    crew_.run(attempts_, [&](Workbench &bench, std::size_t k) {
        return bench.attempt(seeds[k], [&] { return bench.repair.improve(Repair::recipes[recipe], batch_[k]); });
    });
}

void Sweeps::keep_all() {
    std::vector<int> again;
    for (std::size_t k = 0; k < batch_.size(); ++k) {
        const Attempt &made = attempts_[k];
        if (crew_.reached(batch_[k], made) || (made.change && !crew_.has_room(*made.change))) {
            again.push_back(batch_[k]);
            continue;
        }
        crew_.count(made);
        if (!made.change)
            continue;
        const std::vector<int> changed = crew_.keep(*made.change);
        changed_at_.resize(crew_.mesh().tet_slots(), 0);
        ++clock_;
        for (const int t : changed)
            changed_at_[t] = clock_;
    }
    order_.insert(order_.end(), again.rbegin(), again.rend());
}

void Sweeps::run(int recipe, std::vector<int> tets) {
    changed_at_.resize(crew_.mesh().tet_slots(), 0);
    tried_at_[recipe].resize(crew_.mesh().tet_slots(), -1);
    std::erase_if(tets, [&](int t) {
        return !falls_short(t) || (tried_at_[recipe][t] >= 0 && !changed_since(t, tried_at_[recipe][t]));
    });
    crew_.mesh().sort_worst_first(tets);
    order_.assign(tets.rbegin(), tets.rend());
    crew_.gather(order_.size());
    while (!order_.empty()) {
        choose();
        try_all(recipe);
        keep_all();
    }
    tried_at_[recipe].resize(crew_.mesh().tet_slots(), -1);
    for (const int t : tets)
        tried_at_[recipe][t] = clock_;
}

} // namespace wct::search
