#include "move_vertices/vertex_descent.h"

#include <algorithm>
#include <cmath>

namespace wct::move_vertices {

namespace {

constexpr int kSteps = 4;
constexpr int kBacktracks = 6;
constexpr double kLongestStep = 0.3; // in local sizes
constexpr double kFirstStep = 0.1;
constexpr double kFlat = 1e-7; // relative decrease that is not worth another step

/// The inverse Hessian of BFGS in three unknowns.
class Inverse {
  public:
    explicit Inverse(double scale) : row_{{scale, 0.0, 0.0}, {0.0, scale, 0.0}, {0.0, 0.0, scale}} {}

    Vec3 operator*(const Vec3 &v) const { return {dot(row_[0], v), dot(row_[1], v), dot(row_[2], v)}; }

    /// Learn that this step changed the gradient so, `product` = step . change > 0.
    void learn(const Vec3 &step, const Vec3 &change, double product) {
        const Vec3 turned = *this * change;
        const double weight = (1.0 + dot(change, turned) / product) / product;
        const double s[3] = {step.x, step.y, step.z};
        const double t[3] = {turned.x, turned.y, turned.z};
        for (int i = 0; i < 3; ++i)
            row_[i] += (weight * s[i]) * step - (t[i] / product) * step - (s[i] / product) * turned;
    }

  private:
    Vec3 row_[3];
};

/// Returns whether the point moved.
bool relocate_one(MovingMesh &mesh, BoundaryDomain &domain, const Objective &objective, std::int32_t point,
                  std::vector<energy::TetLanes> &lanes, std::size_t &work) {
    Vec3 &x = mesh.points[static_cast<std::size_t>(point)];
    const double size = mesh.size(point);
    load_star(mesh, point, lanes);
    Vec3 gradient;
    double energy = objective.star(mesh, point, lanes, gradient, work);
    gradient = domain.tangential(point, x, gradient);
    if (!std::isfinite(energy) || !(norm(gradient) * size > 1e-9))
        return false;
    bool moved = false;
    Inverse inverse(kFirstStep * size / norm(gradient));
    for (int k = 0; k < kSteps; ++k) {
        const Vec3 d = domain.tangential(point, x, Vec3{} - inverse * gradient);
        const double slope = dot(d, gradient);
        const double length = norm(d);
        if (!(slope < 0.0) || length < 1e-7 * size)
            break;
        const Vec3 from = x;
        double t = std::min(1.0, kLongestStep * size / length);
        double trial = 0.0;
        Vec3 next;
        bool lower = false;
        for (int backtrack = 0; backtrack < kBacktracks && !lower; ++backtrack, t *= 0.3) {
            x = domain.retract(point, from + t * d);
            trial = objective.star(mesh, point, lanes, next, work);
            lower = trial <= energy + 1e-4 * t * slope && trial < energy && domain.admit(point, mesh.points);
        }
        if (!lower) {
            x = from;
            break;
        }
        moved = true;
        next = domain.tangential(point, x, next);
        const Vec3 step = x - from;
        const Vec3 change = next - gradient;
        const double product = dot(step, change);
        if (product > 1e-14 * dot(change, change)) {
            if (k == 0)
                inverse = Inverse(product / dot(change, change));
            inverse.learn(step, change, product);
        }
        const double gain = energy - trial;
        energy = trial;
        gradient = next;
        if (gain <= kFlat * energy)
            break;
    }
    return moved;
}

} // namespace

std::size_t relocate(MovingMesh &mesh, BoundaryDomain &domain, const Objective &objective,
                     std::span<const std::int32_t> points, int sweeps, Monitor &monitor) {
    std::vector<energy::TetLanes> lanes;
    std::size_t moves = 0;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        moves = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            std::size_t work = 0;
            moves += relocate_one(mesh, domain, objective, points[i], lanes, work);
            const double done = (sweep + static_cast<double>(i) / static_cast<double>(points.size())) / sweeps;
            if (!monitor.work(work, done))
                return moves;
        }
        monitor.iterate();
        if (moves == 0)
            break;
    }
    return moves;
}

} // namespace wct::move_vertices
