#include "search/group_descent.h"

#include "base/sort_unique.h"

#include <algorithm>
#include <limits>

namespace wct::search {

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
} // namespace

void GroupDescent::gather(int t) {
    free_.clear();
    tets_.clear();
    number_.resize(complex_.vertex_slots(), -1);
    for (int v : complex_.tet(t))
        for (int s : complex_.star(v))
            for (int w : complex_.tet(s))
                if (number_[w] < 0 && guide_.moves(complex_.vertex(w))) {
                    number_[w] = static_cast<int>(free_.size());
                    free_.push_back(w);
                }
    for (int v : free_)
        tets_.insert(tets_.end(), complex_.star(v).begin(), complex_.star(v).end());
    sort_unique(tets_);
    complex_.sort_worst_first(tets_);
    corners_.resize(tets_.size());
    for (std::size_t k = 0; k < tets_.size(); ++k)
        for (int i = 0; i < 4; ++i)
            corners_[k][i] = number_[complex_.tet(tets_[k])[i]];
    for (int v : free_)
        number_[v] = -1;
}

void GroupDescent::load() {
    const std::size_t groups = (tets_.size() + energy::kLanes - 1) / energy::kLanes;
    lanes_.resize(groups);
    terms_.resize(groups);
    for (std::size_t k = 0; k < groups * energy::kLanes; ++k) {
        const Tet &tet = complex_.tet(tets_[std::min(k, tets_.size() - 1)]);
        for (int i = 0; i < 4; ++i)
            lanes_[k / energy::kLanes].set(static_cast<int>(k % energy::kLanes), i, complex_.point(tet[i]));
        terms_[k / energy::kLanes].needle[static_cast<int>(k % energy::kLanes)] = SearchEnergy::needle(complex_, tet);
    }
    for (std::size_t g = 0; g < groups; ++g)
        terms_[g].bounds = SearchEnergy::present_bounds(lanes_[g]);
}

/// Which way each free vertex may move; false if one may not move at all. On a curved surface that is along it: most of
/// what leaves its tangent plane, the tolerance would refuse in the end.
void GroupDescent::hold() {
    hints_.clear();
    freedoms_.assign(free_.size(), {});
    for (std::size_t i = 0; i < free_.size(); ++i) {
        const Vertex &vertex = complex_.vertex(free_[i]);
        hints_.push_back(vertex.hint);
        if (vertex.stratum == Stratum::interior)
            continue;
        Vec3 x = vertex.position;
        freedoms_[i] = guide_.admit(vertex, x, hints_[i]);
        if (freedoms_[i].kind != Freedom::Kind::space)
            continue;
        watch_.gather(free_[i]);
        if (watch_.cost(nullptr) == 0.0) // else it may have to leave it
            freedoms_[i] = {Freedom::Kind::plane, watch_.normal()};
    }
}

/// Free vertices at from + t step, each on its stratum.
void GroupDescent::place(const energy::Field &from, double t, const energy::Field &step, energy::Field &to) {
    to = from;
    energy::add(to, t, step);
    for (std::size_t i = 0; i < free_.size(); ++i) {
        const Vertex &vertex = complex_.vertex(free_[i]);
        if (vertex.stratum != Stratum::interior)
            guide_.admit(vertex, to[i], hints_[i]);
    }
}

/// The energy there, or infinity if it is above `limit`: then the gradient is not all there.
double GroupDescent::evaluate(const energy::Field &at, double limit, energy::Field &gradient) {
    gradient.assign(free_.size(), {});
    double sum = 0.0;
    for (std::size_t g = 0; g < lanes_.size(); ++g) {
        const std::size_t first = g * energy::kLanes;
        for (int lane = 0; lane < energy::kLanes; ++lane)
            for (int i = 0; i < 4; ++i)
                if (const int n = corners_[std::min(first + lane, tets_.size() - 1)][i]; n >= 0)
                    lanes_[g].set(lane, i, at[n]);
        energy::GradientLanes pull;
        const int used = static_cast<int>(std::min<std::size_t>(energy::kLanes, tets_.size() - first));
        const double left = limit - sum;
        const double here = energy_.smooth(lanes_[g], terms_[g], used, left, pull);
        if (!(here <= left))
            return kInfinity;
        if (here == 0.0)
            continue;
        sum += here;
        for (int lane = 0; lane < used; ++lane)
            for (int i = 0; i < 4; ++i)
                if (const int n = corners_[first + lane][i]; n >= 0)
                    gradient[n] += {pull.corner[i][0][lane], pull.corner[i][1][lane], pull.corner[i][2][lane]};
    }
    for (std::size_t i = 0; i < free_.size(); ++i)
        gradient[i] = freedoms_[i].of(gradient[i]);
    return sum;
}

/// The free vertices of the neighbourhood, for L-BFGS.
class GroupDescent::Moving {
  public:
    Moving(GroupDescent &group, double size) : group_(group), size_(size) {
        for (int v : group.free_)
            at_.push_back(group.complex_.point(v));
    }

    double start(energy::Field &gradient) {
        return start_ = energy_ = group_.evaluate(at_, std::numeric_limits<double>::max(), gradient);
    }

    energy::Field downhill(const energy::Field &gradient) const {
        energy::Field step = gradient;
        for (Vec3 &v : step)
            v = (-kFirst * size_ / energy::longest(gradient)) * v;
        return step;
    }

    void restrain(energy::Field &step) const {
        for (std::size_t i = 0; i < step.size(); ++i)
            step[i] = group_.freedoms_[i].of(step[i]);
    }

    double share(const energy::Field &step) const { return std::min(1.0, kMost * size_ / energy::longest(step)); }

    double attempt(double share, const energy::Field &step, double limit, energy::Field &gradient) {
        group_.place(at_, share, step, next_);
        return tried_ = group_.evaluate(next_, limit, gradient);
    }

    bool yields(energy::Field &) const { return false; }
    bool goes_on(int) const { return true; }

    void accept(energy::LbfgsMemory &memory, const energy::Field &gradient, const energy::Field &slope) {
        memory.remember(at_, next_, gradient, slope);
        at_.swap(next_);
        energy_ = tried_;
    }

    bool lower() const { return energy_ < start_; }
    const energy::Field &at() const { return at_; }

  private:
    static constexpr double kFirst = 0.05, kMost = 0.3; // longest step along the steepest descent, and of all; in sizes

    GroupDescent &group_;
    double size_;
    energy::Field at_, next_; // where the vertices stand, and were tried last
    double start_ = kInfinity, energy_ = kInfinity, tried_ = kInfinity;
};

bool GroupDescent::relax_round(int t) {
    constexpr energy::LbfgsForm form{.memory = 8, .iterations = 10, .trials = 8, .shorter = 0.4, .worth = 1e-3};
    gather(t);
    if (free_.empty())
        return false;
    hold();
    load();
    Moving moving(*this, complex_.vertex(complex_.tet(t)[0]).size);
    energy::descend(moving, form);
    return moving.lower() && settle(moving.at());
}

bool GroupDescent::settle(const energy::Field &at) {
    complex_.mark();
    for (std::size_t i = 0; i < free_.size(); ++i) {
        const int v = free_[i];
        complex_.set_hint(v, hints_[i]);
        if (complex_.vertex(v).stratum == Stratum::interior) {
            complex_.move(v, at[i]);
            continue;
        }
        watch_.gather(v);
        const Vertex &vertex = complex_.vertex(v);
        Vec3 x = at[i];
        bool may = watch_.settle(x);
        if (!may && vertex.stratum == Stratum::patch && !guide_.planar(vertex.label)) {
            x = vertex.position + freedoms_[i].of(x - vertex.position); // not drawn back into the shell
            may = watch_.settle(x);
        }
        if (may)
            complex_.move(v, x);
    }
    measured_.clear();
    for (int t : tets_)
        measured_.push_back(complex_.tet(t));
    energies_.resize(tets_.size());
    energy_.of(complex_, measured_, energies_.data());
    // Where some vertices stayed, a tet may have turned over between them and those that moved.
    if (std::find(energies_.begin(), energies_.end(), kInfinity) != energies_.end()) {
        complex_.rollback();
        return false;
    }
    for (std::size_t k = 0; k < tets_.size(); ++k)
        complex_.set_energy(tets_[k], energies_[k]);
    WCT_CHECK(complex_.checks.did("move_group");)
    complex_.commit();
    return true;
}

} // namespace wct::search
