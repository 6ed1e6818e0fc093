#include "lbfgs.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

namespace wct {

namespace {

constexpr std::size_t kMemory = 10;
constexpr double kLongestStep = 0.3; // in local sizes
constexpr double kFirstStep = 0.05;  // likewise, while nothing is known of the curvature
constexpr double kFlat = 1e-7;       // relative decrease that is not worth another iteration

using Vector = std::vector<Vec3>; // one entry per free point

double inner(const Vector &a, const Vector &b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += dot(a[i], b[i]);
    return sum;
}

void add(Vector &a, double s, const Vector &b) {
    for (std::size_t i = 0; i < a.size(); ++i)
        a[i] += s * b[i];
}

double longest(const Vector &a) {
    double out = 0.0;
    for (const Vec3 &v : a)
        out = std::max(out, dot(v, v));
    return std::sqrt(out);
}

struct Pair {
    Vector step;
    Vector change; // of the gradient
    double product;
};

/// -H g by the two-loop recursion.
Vector direction(const std::deque<Pair> &memory, const Vector &gradient) {
    Vector d = gradient;
    std::vector<double> alpha(memory.size());
    for (std::size_t k = memory.size(); k-- > 0;) {
        alpha[k] = inner(memory[k].step, d) / memory[k].product;
        add(d, -alpha[k], memory[k].change);
    }
    const double scale = memory.empty() ? kFirstStep / longest(gradient)
                                        : memory.back().product / inner(memory.back().change, memory.back().change);
    for (Vec3 &v : d)
        v = -scale * v;
    for (std::size_t k = 0; k < memory.size(); ++k)
        add(d, -alpha[k] - inner(memory[k].change, d) / memory[k].product, memory[k].step);
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
    const auto evaluate = [&](Vector &gradient) {
        const double energy = objective.total(mesh, at, raw, work);
        for (std::size_t i = 0; i < count; ++i) {
            const auto p = static_cast<std::size_t>(free[i]);
            gradient[i] =
                domain.watches(free[i]) ? Vec3{} : mesh.size(free[i]) * domain.tangential(free[i], at[p], raw[p]);
        }
        return energy;
    };
    Vector gradient(count);
    Vector next(count);
    double energy = evaluate(gradient);
    if (!std::isfinite(energy))
        return Outcome::jammed;
    std::deque<Pair> memory;
    for (int k = 0; k < iterations; ++k) {
        if (!(longest(gradient) > 0.0))
            return Outcome::converged;
        Vector d = direction(memory, gradient);
        double slope = inner(d, gradient);
        if (!(slope < 0.0)) {
            memory.clear();
            d = direction(memory, gradient);
            slope = inner(d, gradient);
        }
        double t = std::min(1.0, kLongestStep / longest(d));
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
        Pair pair{Vector(count), Vector(count), 0.0};
        for (std::size_t i = 0; i < count; ++i) {
            const auto p = static_cast<std::size_t>(free[i]);
            pair.step[i] = (1.0 / mesh.size(free[i])) * (at[p] - mesh.points[p]);
            pair.change[i] = next[i] - gradient[i];
            mesh.points[p] = at[p];
        }
        pair.product = inner(pair.step, pair.change);
        if (pair.product > 1e-12 * inner(pair.change, pair.change)) {
            memory.push_back(std::move(pair));
            if (memory.size() > kMemory)
                memory.pop_front();
        }
        const double gain = energy - trial;
        std::swap(gradient, next);
        energy = trial;
        if (gain <= kFlat * energy)
            return Outcome::converged;
    }
    return Outcome::exhausted;
}

} // namespace wct
