#include "move_vertices/joint_descent.h"

#include "energy/lbfgs_memory.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wct::move_vertices {

namespace {

constexpr std::size_t kMemory = 10;
constexpr double kLongestStep = 0.3; // in local sizes
constexpr double kFirstStep = 0.05;  // likewise
constexpr double kFlat = 1e-7;       // relative decrease that is not worth another iteration

/// Downhill; the first step is short, as nothing is known of the curvature.
energy::Field downhill(const energy::LbfgsMemory &memory, const energy::Field &gradient) {
    if (!memory.empty())
        return memory.direction(gradient);
    energy::Field d = gradient;
    const double scale = kFirstStep / energy::longest(gradient);
    for (Vec3 &v : d)
        v = -scale * v;
    return d;
}

} // namespace

Outcome descend(MovingMesh &mesh, Domain &domain, const Objective &objective, int iterations, Monitor &monitor) {
    const auto &free = mesh.free();
    const std::size_t count = free.size();
    if (count == 0)
        return Outcome::converged;
    // Coordinates are counted in local sizes, so that fine and coarse parts of a graded mesh move alike.
    std::vector<Vec3> at = mesh.points;
    std::vector<Vec3> raw(at.size());
    std::size_t work = 0;
    const auto evaluate = [&](energy::Field &gradient) {
        const double energy = objective.total(mesh, at, raw, work);
        for (std::size_t i = 0; i < count; ++i) {
            const auto p = static_cast<std::size_t>(free[i]);
            gradient[i] =
                domain.watches(free[i]) ? Vec3{} : mesh.size(free[i]) * domain.tangential(free[i], at[p], raw[p]);
        }
        return energy;
    };
    energy::Field gradient(count);
    energy::Field next(count);
    double energy = evaluate(gradient);
    if (!std::isfinite(energy))
        return Outcome::jammed;
    energy::LbfgsMemory memory(kMemory);
    for (int k = 0; k < iterations; ++k) {
        if (!(energy::longest(gradient) > 0.0))
            return Outcome::converged;
        energy::Field d = downhill(memory, gradient);
        double slope = energy::inner(d, gradient);
        if (!(slope < 0.0)) {
            memory.clear();
            d = downhill(memory, gradient);
            slope = energy::inner(d, gradient);
        }
        double t = std::min(1.0, kLongestStep / energy::longest(d));
        double trial = 0.0;
        bool lower = false;
        for (int backtrack = 0; backtrack < 20 && !lower; ++backtrack) {
            for (std::size_t i = 0; i < count; ++i) {
                const auto p = static_cast<std::size_t>(free[i]);
                if (!domain.watches(free[i]))
                    at[p] = domain.retract(free[i], mesh.points[p] + (t * mesh.size(free[i])) * d[i]);
            }
            trial = evaluate(next);
            lower = trial <= energy + 1e-4 * t * slope && trial < energy;
            if (!lower)
                t *= 0.4;
        }
        if (!monitor.work(work, static_cast<double>(k) / iterations))
            return Outcome::stopped;
        work = 0;
        if (!lower) {
            if (memory.empty())
                return Outcome::jammed;
            memory.clear();
            continue; // `gradient` still belongs to the positions in the mesh
        }
        monitor.iterate();
        energy::Field step(count), change(count);
        for (std::size_t i = 0; i < count; ++i) {
            const auto p = static_cast<std::size_t>(free[i]);
            step[i] = (1.0 / mesh.size(free[i])) * (at[p] - mesh.points[p]);
            change[i] = next[i] - gradient[i];
            mesh.points[p] = at[p];
        }
        memory.remember(std::move(step), std::move(change));
        const double gain = energy - trial;
        std::swap(gradient, next);
        energy = trial;
        if (gain <= kFlat * energy)
            return Outcome::converged;
    }
    return Outcome::exhausted;
}

} // namespace wct::move_vertices
