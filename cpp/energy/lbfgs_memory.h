#pragma once

#include "base/vec3.h"

#include <deque>
#include <vector>

namespace wct::energy {

/// One vector per point: positions, steps, gradients.
using Field = std::vector<Vec3>;

double inner(const Field &a, const Field &b);
/// a += s b
void add(Field &a, double s, const Field &b);
/// Length of the longest vector.
double longest(const Field &a);

/// What L-BFGS remembers of the curvature: its last steps and how they changed the gradient (Nocedal and Wright,
/// "Numerical Optimization", algorithm 7.4).
class LbfgsMemory {
  public:
    explicit LbfgsMemory(std::size_t most) : most_(most) {}

    bool empty() const { return pairs_.empty(); }
    void clear() { pairs_.clear(); }
    /// Remember a step and the gradient's change along it, unless the energy does not curve upwards there.
    void remember(Field step, Field change);
    /// The same, from positions and gradients before and after the step.
    void remember(const Field &from, const Field &to, const Field &gradient, const Field &slope);
    /// Minus the inverse Hessian times the gradient; something must be remembered.
    Field direction(const Field &gradient) const;

  private:
    struct Pair {
        Field step, change;
        double scale;
    };
    std::size_t most_;
    std::deque<Pair> pairs_;
};

} // namespace wct::energy
