#pragma once

#include "energy/lbfgs_memory.h"

#include <limits>
#include <utility>

namespace wct::energy {

/// Why a descent came to rest: it hardly gained any more; no step along the steepest descent lowers the energy, which
/// has a kink there or was infinite at the start; so many iterations were done; the problem did not want to go on.
enum class Outcome { converged, jammed, exhausted, stopped };

struct LbfgsForm {
    std::size_t memory = 8; // steps remembered
    int iterations = 10;
    int trials = 8;       // of shorter and shorter steps
    double shorter = 0.4; // what a step that fails is shortened to
    double worth = 1e-3;  // relative gain for which to go on
    /// How often nothing may be found along a step before the steepest descent is no longer tried instead.
    int failures = std::numeric_limits<int>::max();
};

/// L-BFGS (Nocedal 1980) with backtracking from where the problem stands to a lower energy. The problem has
///
///   double start(Field &gradient);             // the energy and its gradient where it stands
///   Field downhill(const Field &gradient);     // a step along the steepest descent, where no curvature is known yet
///   void restrain(Field &step);                // take out of a step what may not be
///   double share(const Field &step);           // of it to be tried first
///   double attempt(double share, const Field &step, double limit, Field &gradient);
///                                              // the same at a share of the step; infinite where it may not go, or
///                                              // where the energy is above the limit
///   bool yields(Field &step);                  // whether it changed the step refused last, which else is shortened
///   bool goes_on(int iteration);               // whether to go on after the trials of one step
///   void accept(LbfgsMemory &memory, const Field &gradient, const Field &slope);
///                                              // stand at the attempt made last, and remember the step
///
/// and from any one place to the next a lower energy, by a share of what the slope promises (Armijo 1966).
template <class Problem> Outcome descend(Problem &problem, const LbfgsForm &form) {
    constexpr double sufficient = 1e-4; // share of the slope's promise
    Field gradient, slope;
    double energy = problem.start(gradient);
    if (!(energy < std::numeric_limits<double>::infinity()))
        return Outcome::jammed;
    LbfgsMemory memory(form.memory);
    int failures = 0;
    for (int k = 0; k < form.iterations; ++k) {
        if (!(longest(gradient) > 0.0))
            return Outcome::converged;
        Field step = memory.empty() ? problem.downhill(gradient) : memory.direction(gradient);
        problem.restrain(step);
        double descent = inner(gradient, step);
        if (!(descent < 0.0) && !memory.empty()) {
            memory.clear();
            step = problem.downhill(gradient);
            problem.restrain(step);
            descent = inner(gradient, step);
        }
        double share = problem.share(step);
        double trial = energy;
        bool lower = false;
        for (int n = 0; n < form.trials && descent < 0.0 && !lower; ++n) {
            const double limit = energy + sufficient * share * descent;
            trial = problem.attempt(share, step, limit, slope);
            lower = trial <= limit && trial < energy;
            if (lower)
                break;
            if (problem.yields(step))
                descent = inner(gradient, step);
            else
                share *= form.shorter;
        }
        if (!problem.goes_on(k))
            return Outcome::stopped;
        if (!lower) {
            if (memory.empty() || ++failures > form.failures)
                return Outcome::jammed;
            memory.clear();
            continue;
        }
        problem.accept(memory, gradient, slope);
        const double gain = energy - trial;
        std::swap(gradient, slope);
        energy = trial;
        if (gain <= form.worth * energy)
            return Outcome::converged;
    }
    return Outcome::exhausted;
}

} // namespace wct::energy
