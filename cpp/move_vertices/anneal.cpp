#include "move_vertices/anneal.h"

#include "base/multiversion.h"
#include "base/random.h"
#include "move_vertices/objective.h"

#include <algorithm>
#include <cmath>

namespace wct::move_vertices {

namespace {

struct Cost {
    double margin;
    double near; // per unit of the margin
    double step;
    double slope;
    double width;

    WCT_INLINE double of(double z) const {
        const double below = z < 0.0 ? -z : 0.0;
        const double missed = margin - z > 0.0 ? margin - z : 0.0;
        return slope * (below < width ? below : width) + (z <= kClear ? step : 0.0) +
               near * (missed < margin ? missed : margin);
    }
};

/// The cost at a point of the run: 0 at its start, 1 at nine tenths and from there on.
Cost cost_at(double done, double margin, double near) {
    const double s = std::min(1.0, done / 0.9);
    return {margin, margin > 0.0 ? near / margin : 0.0, 0.5 * s, 3.0, 0.3 + (0.1 - 0.3) * s};
}

WCT_MULTIVERSION
void cost_of(const energy::WorstLanes &worst, const Cost &cost, energy::Lanes &z, energy::Lanes &out) {
    for (int lane = 0; lane < energy::kLanes; ++lane) {
        const double value = worst.height[lane] < worst.cosine[lane] ? worst.height[lane]
                                                                     : worst.cosine[lane]; // cosine 1: not asked for
        z[lane] = value;
        out[lane] = cost.of(value);
    }
}

/// What is known of each tet at the current positions.
struct TetState {
    double z;
    double cost;
};

class Search {
  public:
    Search(MovingMesh &mesh, BoundaryDomain &domain, Goal goal, std::uint64_t seed)
        : mesh_(mesh), domain_(domain), cosines_(goal == Goal::completely_well_centered), random_(seed),
          state_(mesh.tets().size()), reach_(mesh.points.size()) {
        for (const auto p : mesh.free())
            reach_[static_cast<std::size_t>(p)] = 0.1 * mesh.size(p);
        energy::TetLanes lanes;
        energy::WorstLanes worst;
        const std::span active(mesh.active());
        for (std::size_t first = 0; first < active.size(); first += energy::kLanes) {
            const auto which = active.subspan(first, std::min<std::size_t>(energy::kLanes, active.size() - first));
            load_tets(mesh.points, mesh.tets(), which, lanes);
            energy::measure_worst(lanes, cosines_, worst);
            for (std::size_t k = 0; k < which.size(); ++k) {
                const int lane = static_cast<int>(k);
                state_[static_cast<std::size_t>(which[k])].z = std::min(worst.height[lane], worst.cosine[lane]);
            }
        }
    }

    void set_cost(const Cost &cost) {
        cost_ = cost;
        for (const auto t : mesh_.active()) {
            TetState &state = state_[static_cast<std::size_t>(t)];
            state.cost = cost.of(state.z);
        }
    }

    /// Offer the point one random move and take it by the rule of Metropolis.
    void try_move(std::int32_t point, double temperature, std::size_t &work) {
        const auto around = mesh_.star(point);
        double before = 0.0;
        for (const StarTet &s : around)
            before += state_[static_cast<std::size_t>(s.tet)].cost;
        Vec3 &x = mesh_.points[static_cast<std::size_t>(point)];
        double &reach = reach_[static_cast<std::size_t>(point)];
        const Vec3 from = x;
        const Vec3 direction = in_ball();
        // Drawn beforehand, so that a star already dearer than this need not be seen to its end. log(0) is never asked.
        const double limit = before - temperature * std::log(1.0 - random_.uniform());
        x = domain_.retract(point, from + reach * direction);
        load_star(mesh_, point, lanes_);
        if (cost_of_star(point, limit, work) && domain_.admit(point, mesh_.points)) {
            for (std::size_t k = 0; k < around.size(); ++k)
                state_[static_cast<std::size_t>(around[k].tet)] = trial_[k];
            reach = std::min(1.1 * reach, 0.5 * mesh_.size(point));
        } else {
            x = from;
            reach = std::max(0.98 * reach, 1e-4 * mesh_.size(point));
        }
    }

  private:
    Vec3 in_ball() {
        for (;;) {
            const double a = 2.0 * random_.uniform() - 1.0;
            const double b = 2.0 * random_.uniform() - 1.0;
            const double c = 2.0 * random_.uniform() - 1.0;
            if (a * a + b * b + c * c <= 1.0)
                return {a, b, c};
        }
    }

    /// Fill trial_ for the point where it now is; false as soon as a tet is not allowed or the limit is passed.
    bool cost_of_star(std::int32_t point, double limit, std::size_t &work) {
        const auto around = mesh_.star(point);
        if (trial_.size() < around.size())
            trial_.resize(around.size());
        energy::WorstLanes worst;
        energy::Lanes z;
        energy::Lanes cost;
        double sum = 0.0;
        for (std::size_t first = 0; first < around.size(); first += energy::kLanes) {
            const std::size_t count = std::min<std::size_t>(energy::kLanes, around.size() - first);
            energy::TetLanes &block = lanes_[first / energy::kLanes];
            block.set_all(0, mesh_.points[static_cast<std::size_t>(point)]);
            energy::measure_worst(block, cosines_, worst);
            cost_of(worst, cost_, z, cost);
            work += count;
            for (std::size_t k = 0; k < count; ++k) {
                const int lane = static_cast<int>(k);
                const std::int32_t tet = around[first + k].tet;
                if (!(worst.flatness[lane] > mesh_.floor(tet)) ||
                    !mesh_.positive(tet, worst.flatness[lane], mesh_.points))
                    return false;
                sum += cost[lane];
                trial_[first + k] = {z[lane], cost[lane]};
            }
            if (!(sum <= limit))
                return false;
        }
        return true;
    }

    MovingMesh &mesh_;
    BoundaryDomain &domain_;
    bool cosines_;
    Random random_;
    Cost cost_{};
    std::vector<TetState> state_; // per tet
    std::vector<double> reach_;   // per point: the radius of its moves, which follows how many are taken
    std::vector<energy::TetLanes> lanes_;
    std::vector<TetState> trial_;
};

} // namespace

void anneal(MovingMesh &mesh, BoundaryDomain &domain, Goal goal, double margin, const Annealing &annealing,
            std::span<const std::int32_t> points, Monitor &monitor) {
    Search search(mesh, domain, goal, annealing.seed);
    const int frozen = annealing.sweeps / 20;
    const int warm = std::max(1, annealing.sweeps - frozen);
    const int renew = std::max(1, warm / 40); // the cost changes in steps: each renews what is known of every tet
    for (int sweep = 0; sweep < annealing.sweeps; ++sweep) {
        const double done =
            std::min(1.0, annealing.start + (1.0 - annealing.start) * static_cast<double>(sweep) / warm);
        if (sweep % renew == 0)
            search.set_cost(cost_at(done, margin, annealing.near));
        const double temperature = sweep < warm ? annealing.hot * std::pow(annealing.cold / annealing.hot, done) : 0.0;
        for (const auto p : points) {
            std::size_t work = 0;
            search.try_move(p, temperature, work);
            if (!monitor.work(work, static_cast<double>(sweep) / annealing.sweeps))
                return;
        }
        monitor.iterate();
    }
}

} // namespace wct::move_vertices
