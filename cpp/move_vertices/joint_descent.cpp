#include "move_vertices/joint_descent.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace wct::move_vertices {

namespace {

constexpr double kLongestStep = 0.3; // in local sizes
constexpr double kFirstStep = 0.05;  // likewise
constexpr energy::LbfgsForm kForm{.memory = 10, .trials = 20, .shorter = 0.4, .worth = 1e-7};

/// The free points of a mesh, for L-BFGS. Steps are counted in local sizes, so that fine and coarse parts of a graded
/// mesh move alike.
class FreePoints {
  public:
    FreePoints(MovingMesh &mesh, BoundaryDomain &domain, const Objective &objective, int iterations, Monitor &monitor)
        : mesh_(mesh), domain_(domain), objective_(objective), iterations_(iterations), monitor_(monitor),
          at_(mesh.points), raw_(mesh.points.size()) {}

    double start(energy::Field &gradient) { return evaluate(gradient); }

    /// Short, as nothing is known of the curvature.
    energy::Field downhill(const energy::Field &gradient) const {
        energy::Field step = gradient;
        const double scale = kFirstStep / energy::longest(gradient);
        for (Vec3 &v : step)
            v = -scale * v;
        return step;
    }

    void restrain(energy::Field &) const {}
    double share(const energy::Field &step) const { return std::min(1.0, kLongestStep / energy::longest(step)); }
    bool yields(energy::Field &) const { return false; }

    double attempt(double share, const energy::Field &step, double, energy::Field &gradient) {
        for (std::size_t i = 0; i < step.size(); ++i) {
            const std::int32_t p = mesh_.free()[i];
            if (!domain_.watches(p))
                at_[place(p)] = domain_.retract(p, mesh_.points[place(p)] + (share * mesh_.size(p)) * step[i]);
        }
        return evaluate(gradient);
    }

    bool goes_on(int iteration) {
        return monitor_.work(std::exchange(work_, 0), static_cast<double>(iteration) / iterations_);
    }

    void accept(energy::LbfgsMemory &memory, const energy::Field &gradient, const energy::Field &slope) {
        monitor_.iterate();
        const auto &free = mesh_.free();
        energy::Field step(free.size()), change(free.size());
        for (std::size_t i = 0; i < free.size(); ++i) {
            Vec3 &from = mesh_.points[place(free[i])];
            const Vec3 &to = at_[place(free[i])];
            step[i] = (1.0 / mesh_.size(free[i])) * (to - from);
            change[i] = slope[i] - gradient[i];
            from = to;
        }
        memory.remember(std::move(step), std::move(change));
    }

  private:
    static std::size_t place(std::int32_t point) { return static_cast<std::size_t>(point); }

    double evaluate(energy::Field &gradient) {
        const auto &free = mesh_.free();
        const double energy = objective_.total(mesh_, at_, raw_, work_);
        gradient.resize(free.size());
        for (std::size_t i = 0; i < free.size(); ++i) {
            const std::int32_t p = free[i];
            gradient[i] =
                domain_.watches(p) ? Vec3{} : mesh_.size(p) * domain_.tangential(p, at_[place(p)], raw_[place(p)]);
        }
        return energy;
    }

    MovingMesh &mesh_;
    BoundaryDomain &domain_;
    const Objective &objective_;
    int iterations_;
    Monitor &monitor_;
    std::vector<Vec3> at_;
    std::vector<Vec3> raw_; // gradients of all points
    std::size_t work_ = 0;  // since the monitor was told
};

} // namespace

Outcome descend(MovingMesh &mesh, BoundaryDomain &domain, const Objective &objective, int iterations,
                Monitor &monitor) {
    if (mesh.free().empty())
        return Outcome::converged;
    FreePoints points(mesh, domain, objective, iterations, monitor);
    energy::LbfgsForm form = kForm;
    form.iterations = iterations;
    return energy::descend(points, form);
}

} // namespace wct::move_vertices
