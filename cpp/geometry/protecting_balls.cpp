#include "geometry/protecting_balls.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wct::geometry {

std::optional<Sphere> protecting_ball(const Sphere &smallest, const Vec3 &n, double lo, double hi) {
    constexpr double room = 1e-6; // between the balls that touch a point on either side, in radii
    if (!(hi - lo > room * smallest.radius))
        return {};
    const double inset = std::min(0.5 * (hi - lo), room * smallest.radius);
    const double x = std::clamp(0.0, lo + inset, hi - inset);
    return Sphere{smallest.center + x * n, std::hypot(smallest.radius, x)};
}

ProtectingBalls::ProtectingBalls(std::vector<Sphere> balls) : balls_(std::move(balls)) {
    std::vector<Box> boxes;
    for (const Sphere &ball : balls_) {
        const Vec3 reach{ball.radius, ball.radius, ball.radius};
        Box box;
        box.add(ball.center - reach);
        box.add(ball.center + reach);
        boxes.push_back(box);
    }
    tree_ = BoxTree(boxes);
}

ProtectingBalls::Depth ProtectingBalls::deepest(const Vec3 &p) const {
    Depth most;
    tree_.visit([&](const Box &box) { return box.contains(p); },
                [&](std::size_t at) {
                    const double here = norm(p - balls_[at].center) / balls_[at].radius;
                    if (here < most.share)
                        most = {static_cast<int>(at), here};
                    return false;
                });
    return most;
}

} // namespace wct::geometry
