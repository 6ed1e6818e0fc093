#include "search/vertex_descent.h"

#include <algorithm>
#include <limits>

namespace wct::search {

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Where the surface refuses so many steps of one line search, shorter ones would gain little for what asking costs.
constexpr int kRefusals = 3;
constexpr double kShorter = 0.3; // what a step that fails is shortened to
/// What a step along the surface must have of the slope of one that leaves it.
constexpr double kSlide = 0.1;

} // namespace

bool StarDescent::settle(int v, const Vec3 &x) {
    if (complex_.vertex(v).stratum != Stratum::interior && !watch_.settle(x))
        return false;
    complex_.move(v, x);
    energies_.resize(star_.lanes.size() * energy::kLanes);
    energy_.each(star_, x, energies_.data());
    for (std::size_t k = 0; k < star_.tets.size(); ++k)
        complex_.set_energy(star_.tets[k], energies_[k] + energy_.over(complex_, complex_.tet(star_.tets[k])));
    WCT_CHECK(complex_.checks.did("move");)
    return true;
}

bool StarDescent::relax(int v, int steps) {
    const Vertex &vertex = complex_.vertex(v);
    if (!movable(v) || !complex_.used(v))
        return false;
    double stored = 0.0;
    for (int t : complex_.star(v))
        stored += complex_.energy(t);
    if (stored <= 0.0)
        return false;
    energy_.gather(complex_, v, star_);
    Vec3 x = vertex.position;
    Vec3 gradient;
    double start = energy_.at(star_, x, &gradient);
    const bool surface = vertex.stratum != Stratum::interior;
    const double over_weight = energy_.form().over_weight;
    Freedom freedom;
    std::int32_t hint = vertex.hint;
    if (surface) {
        Vec3 place = x;
        if (!guide_.admit(vertex, place, &freedom, hint))
            return false;
        watch_.gather(v);
        Vec3 pull;
        start += over_weight * watch_.cost(&pull);
        gradient = freedom.of(gradient + over_weight * pull);
    }
    if (start <= 0.0 || start == kInfinity)
        return false;
    double length = 0.0; // mean distance to the neighbours, each as often as tets share it
    for (int t : complex_.star(v))
        for (int w : complex_.tet(t))
            length += norm(complex_.point(w) - x);
    length /= 3.0 * static_cast<double>(complex_.star(v).size());

    const double steepness = norm(gradient);
    if (steepness * length < 1e-9)
        return false;
    double h[3][3] = {};
    for (int i = 0; i < 3; ++i)
        h[i][i] = 0.1 * length / steepness;
    const auto times = [&h](const Vec3 &g) {
        return Vec3{h[0][0] * g.x + h[0][1] * g.y + h[0][2] * g.z, h[1][0] * g.x + h[1][1] * g.y + h[1][2] * g.z,
                    h[2][0] * g.x + h[2][1] * g.y + h[2][2] * g.z};
    };
    double current = start;
    for (int step = 0; step < steps && current > 0.0; ++step) {
        Vec3 d = freedom.of(-1.0 * times(gradient));
        double slope = dot(d, gradient);
        const double reach = norm(d);
        if (slope >= 0.0 || reach < 1e-6 * length)
            break;
        double t = reach > 0.3 * length ? 0.3 * length / reach : 1.0;
        bool moved = false;
        int refused = 0;
        Vec3 next, next_gradient;
        Freedom next_freedom;
        double next_energy = kInfinity;
        for (int trial = 0; trial < 7 && !moved; ++trial, t *= kShorter) {
            next = x + t * d;
            if (surface && !guide_.admit(vertex, next, &next_freedom, hint))
                continue;
            const double limit = current + 1e-4 * t * slope;
            next_energy = energy_.at(star_, next, &next_gradient, limit);
            if (next_energy > limit)
                continue;
            if (surface && !watch_.allows(next)) {
                if (++refused == kRefusals)
                    break;
                // Mostly the tolerance is in the way: a step along the surface may gain as much.
                if (refused == 1 && freedom.kind == Freedom::Kind::space) {
                    const Vec3 normal = watch_.normal();
                    const Vec3 along = d - dot(d, normal) * normal;
                    if (const double left = dot(along, gradient); left < kSlide * slope) {
                        d = along;
                        slope = left;
                        t /= kShorter; // the next trial takes as long a step
                    }
                }
                continue;
            }
            if (surface) {
                Vec3 pull;
                next_energy += over_weight * watch_.cost(&pull);
                next_gradient += over_weight * pull;
            }
            moved = next_energy <= limit;
        }
        if (!moved)
            break;
        freedom = next_freedom;
        next_gradient = freedom.of(next_gradient);
        const Vec3 s = next - x;
        const Vec3 y = next_gradient - gradient;
        const double sy = dot(s, y);
        const double yy = dot(y, y);
        const double drop = current - next_energy;
        current = next_energy;
        x = next;
        gradient = next_gradient;
        if (sy > 1e-14 * yy && sy > 0.0) {
            if (step == 0)
                for (int i = 0; i < 3; ++i)
                    for (int j = 0; j < 3; ++j)
                        h[i][j] = i == j ? sy / yy : 0.0;
            const double rho = 1.0 / sy;
            const Vec3 hy = times(y);
            const double curvature = (1.0 + dot(y, hy) * rho) * rho;
            const double sa[3] = {s.x, s.y, s.z};
            const double ha[3] = {hy.x, hy.y, hy.z};
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    h[i][j] += curvature * sa[i] * sa[j] - rho * (ha[i] * sa[j] + sa[i] * ha[j]);
        }
        if (drop < 1e-5 * start)
            break;
    }
    complex_.set_hint(v, hint);
    return current < start && settle(v, x);
}

bool StarDescent::nudge(int v, const Vec3 &x) {
    const Vertex &vertex = complex_.vertex(v);
    if (!movable(v) || !complex_.used(v))
        return false;
    const bool surface = vertex.stratum != Stratum::interior;
    if (surface)
        watch_.gather(v);
    energy_.gather(complex_, v, star_);
    Vec3 step = x - vertex.position;
    for (int trial = 0; trial < 3; ++trial, step = 0.4 * step) {
        Vec3 place = vertex.position + step;
        if (surface && !guide_.admit(vertex, place))
            continue;
        if (energy_.at(star_, place, nullptr) < kInfinity && (!surface || watch_.allows(place)))
            return settle(v, place);
    }
    return false;
}

} // namespace wct::search
