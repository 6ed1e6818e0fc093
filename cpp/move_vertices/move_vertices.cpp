#include "move_vertices/move_vertices.h"

#include "move_vertices/boundary_domain.h"
#include "move_vertices/joint_descent.h"
#include "move_vertices/moving_mesh.h"
#include "move_vertices/vertex_descent.h"

#include <algorithm>

namespace wct::move_vertices {

namespace {

constexpr double kMany = 0.05; // share of tets off the goal above which a search melts the whole mesh
constexpr int kMends = 3;

/// The rounds that lead from the input to the result. Each starts from the best positions so far.
class Course {
  public:
    Course(MovingMesh mesh, BoundaryDomain &domain, const Aim &aim, Monitor &monitor)
        : mesh_(std::move(mesh)), domain_(domain), aim_(aim), monitor_(monitor), judge_(aim.goal, aim.margin),
          points_(mesh_.points), start_(judge_.judge(points_, mesh_.tets())), best_(start_) {
        monitor_.set_bad(missing());
    }

    Result run() {
        monitor_.report(0.0);
        if (!mesh_.free().empty() && missing() > 0) {
            smooth(0.05);
            if (missing() > kMany * static_cast<double>(mesh_.tets().size()))
                search(0.55);
            for (int round = 0; round < kMends; ++round)
                mend(0.1, static_cast<std::uint64_t>(round));
        }
        if (!mesh_.free().empty() && best_.worst < aim_.margin)
            settle(0.1);
        if (!mesh_.free().empty() && missing() == 0 && best_.worst < aim_.margin)
            polish(0.05);
        monitor_.report(1.0);
        return {std::move(points_), start_, best_};
    }

  private:
    std::int64_t missing() const { return static_cast<std::int64_t>(mesh_.tets().size()) - best_.meeting; }

    bool begin(double share) {
        monitor_.begin(share);
        mesh_.points = points_;
        domain_.restore();
        return !monitor_.stopped();
    }

    /// Keep the mesh's positions if they are the best so far.
    void consider() {
        const Verdict verdict = judge_.judge(mesh_.points, mesh_.tets());
        if (judge_.better(verdict, best_, start_, mesh_.tets().size())) {
            best_ = verdict;
            points_ = mesh_.points;
            domain_.keep();
            monitor_.set_bad(missing());
        }
    }

    double weight2() const { return aim_.goal == Goal::completely_well_centered ? 0.5 : 0.0; }

    /// Free points of tets that miss the goal, and those up to so many edges away.
    std::vector<std::int32_t> around_bad(int rings) const {
        const auto meeting = judge_.meeting(mesh_.points, mesh_.tets());
        std::vector<bool> chosen(mesh_.tets().size());
        for (std::size_t t = 0; t < chosen.size(); ++t)
            chosen[t] = !meeting[t];
        std::vector<bool> marked(mesh_.points.size());
        for (int ring = 0;; ++ring) {
            for (const auto t : mesh_.active())
                if (chosen[static_cast<std::size_t>(t)])
                    for (const auto corner : mesh_.tets()[static_cast<std::size_t>(t)])
                        marked[static_cast<std::size_t>(corner)] = true;
            if (ring == rings)
                break;
            for (const auto t : mesh_.active())
                for (const auto corner : mesh_.tets()[static_cast<std::size_t>(t)])
                    if (marked[static_cast<std::size_t>(corner)])
                        chosen[static_cast<std::size_t>(t)] = true;
        }
        std::vector<std::int32_t> out;
        for (const auto p : mesh_.free())
            if (marked[static_cast<std::size_t>(p)])
                out.push_back(p);
        return out;
    }

    /// Downhill all together, and one by one where that jams.
    void descend_and_relocate(const Objective &objective, int iterations) {
        const Outcome outcome = descend(mesh_, domain_, objective, iterations, monitor_);
        if (outcome == Outcome::jammed)
            relocate(mesh_, domain_, objective, around_bad(0), 3, monitor_);
    }

    /// Bring the bulk into shape under the smooth energy.
    void smooth(double share) {
        if (!begin(share))
            return;
        energy::EnergyForm form;
        form.weight2 = weight2();
        descend_and_relocate(Objective(form), 60 * aim_.effort);
        consider();
    }

    /// Search everywhere for the positions that serve the most tets.
    void search(double share) {
        if (!begin(share))
            return;
        Annealing annealing;
        annealing.sweeps = 2000 * aim_.effort;
        anneal(mesh_, domain_, aim_.goal, aim_.margin, annealing, mesh_.free(), monitor_);
        consider();
    }

    /// Search again about the tets that still miss the goal, from a lower temperature that leaves the rest in place.
    void mend(double share, std::uint64_t round) {
        if (!begin(share))
            return;
        Annealing annealing;
        annealing.start = 0.7;
        annealing.sweeps = 300 * aim_.effort;
        annealing.seed = 2 + round;
        anneal(mesh_, domain_, aim_.goal, aim_.margin, annealing, around_bad(2), monitor_);
        consider();
    }

    /// Widen margins as a last, cold search, which gives up hardly any tet that meets the goal.
    void settle(double share) {
        if (!begin(share) || !(aim_.margin > 0.0))
            return;
        Annealing annealing;
        annealing.hot = annealing.cold = 0.002;
        annealing.start = 1.0;
        annealing.near = 0.2;
        annealing.sweeps = 300 * aim_.effort;
        anneal(mesh_, domain_, aim_.goal, aim_.margin, annealing, mesh_.free(), monitor_);
        consider();
    }

    /// Where all tets meet the goal: widen the smallest margins, none falling below the smallest of all.
    void polish(double share) {
        if (!begin(share))
            return;
        Emphasis emphasis;
        const double least = best_.worst - 0.5 * PositionJudge::kRounding;
        emphasis.height.assign(mesh_.tets().size(), least);
        emphasis.cosine.assign(mesh_.tets().size(), least);
        const double margin = 1.25 * aim_.margin; // what is aimed at with a square is never quite reached
        const Objective objective({margin, 2.0, margin, 2.0, weight2() > 0.0 ? 1.0 : 0.0, 0.0}, std::move(emphasis));
        descend(mesh_, domain_, objective, 60 * aim_.effort, monitor_);
        relocate(mesh_, domain_, objective, mesh_.free(), 10 * aim_.effort, monitor_);
        consider();
    }

    MovingMesh mesh_;
    BoundaryDomain &domain_;
    Aim aim_;
    Monitor &monitor_;
    PositionJudge judge_;
    std::vector<Vec3> points_; // the best so far
    Verdict start_;
    Verdict best_;
};

} // namespace

Result well_center(const Problem &problem, const Aim &aim, Monitor &monitor) {
    const auto order = spatial_order(problem.points);
    const Problem ordered = renumbered(problem, order);
    BoundaryDomain domain(ordered, aim.tolerance);
    std::vector<bool> free(ordered.points.size());
    for (std::size_t p = 0; p < free.size(); ++p)
        free[p] = domain.moves(static_cast<std::int32_t>(p));
    Result result = Course(MovingMesh(ordered.points, ordered.tets, free), domain, aim, monitor).run();
    std::vector<Vec3> points(order.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        points[static_cast<std::size_t>(order[i])] = result.points[i];
    result.points = std::move(points);
    return result;
}

} // namespace wct::move_vertices
