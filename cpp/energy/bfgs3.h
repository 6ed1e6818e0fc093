#pragma once

#include "base/vec3.h"

namespace wct::energy {

/// Inverse Hessian of a function of three unknowns, as BFGS learns it from steps and what they change in the gradient
/// (Nocedal and Wright, "Numerical Optimization", equation 6.17).
class InverseHessian3 {
  public:
    explicit InverseHessian3(double scale) { reset(scale); }

    Vec3 operator*(const Vec3 &g) const {
        return {h_[0][0] * g.x + h_[0][1] * g.y + h_[0][2] * g.z, h_[1][0] * g.x + h_[1][1] * g.y + h_[1][2] * g.z,
                h_[2][0] * g.x + h_[2][1] * g.y + h_[2][2] * g.z};
    }

    /// Learn that this step changed the gradient so, unless the function does not curve upwards along it. The `first`
    /// step sets the scale for all directions.
    void learn(const Vec3 &step, const Vec3 &change, bool first) {
        constexpr double least = 1e-14; // curvature below this, relative to the gradient's change squared, is noise
        const double product = dot(step, change);
        const double square = dot(change, change);
        if (!(product > least * square && product > 0.0))
            return;
        if (first)
            reset(product / square);
        const double rho = 1.0 / product;
        const Vec3 turned = *this * change;
        const double curvature = (1.0 + dot(change, turned) * rho) * rho;
        const double s[3] = {step.x, step.y, step.z};
        const double t[3] = {turned.x, turned.y, turned.z};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                h_[i][j] += curvature * s[i] * s[j] - rho * (t[i] * s[j] + s[i] * t[j]);
    }

  private:
    void reset(double scale) {
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                h_[i][j] = i == j ? scale : 0.0;
    }

    double h_[3][3];
};

} // namespace wct::energy
