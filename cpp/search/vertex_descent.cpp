#include "search/vertex_descent.h"

#include "energy/bfgs3.h"

#include <algorithm>
#include <limits>

namespace wct::search {

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Of steps, in mean distances to the neighbours: the first along the gradient, the longest, and what is no step.
constexpr double kFirst = 0.1;
constexpr double kLongest = 0.3;
constexpr double kShortest = 1e-6;
/// Energy that a move by the mean distance to the neighbours would gain at most where the vertex rests.
constexpr double kLevel = 1e-9;
/// Share of the energy at the start that the last step must have gained for another.
constexpr double kWorth = 1e-5;
/// What a step must gain of what the slope at its start promises (Armijo 1966).
constexpr double kSufficient = 1e-4;
constexpr int kTrials = 7;       // of shorter and shorter steps
constexpr double kShorter = 0.3; // what a step that fails is shortened to
/// Where the surface refuses so many steps of one line search, shorter ones would gain little for what asking costs.
constexpr int kRefusals = 3;
/// What a step along the surface must have of the slope of one that leaves it.
constexpr double kSlide = 0.1;

} // namespace

bool VertexDescent::settle(int v, const Vec3 &x) {
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

double VertexDescent::neighbour_distance(int v) const {
    double sum = 0.0;
    for (int t : complex_.star(v))
        for (int w : complex_.tet(t))
            sum += norm(complex_.point(w) - complex_.point(v));
    return sum / (3.0 * static_cast<double>(complex_.star(v).size()));
}

void VertexDescent::add_watched(Place &place) const {
    const double weight = energy_.form().over_weight;
    Vec3 pull;
    place.energy += weight * watch_.cost(&pull);
    place.gradient += weight * pull;
}

bool VertexDescent::start(int v, std::int32_t &hint, Place &place) {
    double stored = 0.0;
    for (int t : complex_.star(v))
        stored += complex_.energy(t);
    if (stored <= 0.0)
        return false;
    energy_.gather(complex_, v, star_);
    const Vertex &vertex = complex_.vertex(v);
    place.x = vertex.position;
    place.energy = energy_.at(star_, place.x, &place.gradient);
    if (vertex.stratum != Stratum::interior) {
        Vec3 admitted = place.x;
        place.freedom = guide_.admit(vertex, admitted, hint);
        watch_.gather(v);
        add_watched(place);
        place.gradient = place.freedom.of(place.gradient);
    }
    return place.energy > 0.0 && place.energy < kInfinity;
}

bool VertexDescent::slide(const Vec3 &gradient, Vec3 &d, double &slope) const {
    const Vec3 normal = watch_.normal();
    const Vec3 along = d - dot(d, normal) * normal;
    const double left = dot(along, gradient);
    if (!(left < kSlide * slope))
        return false;
    d = along;
    slope = left;
    return true;
}

bool VertexDescent::step_down(const Vertex &vertex, const Place &from, Vec3 d, double length, std::int32_t &hint,
                              Place &to) {
    double slope = dot(d, from.gradient);
    const double reach = norm(d);
    if (slope >= 0.0 || reach < kShortest * length)
        return false;
    const bool surface = vertex.stratum != Stratum::interior;
    double t = reach > kLongest * length ? kLongest * length / reach : 1.0;
    int refused = 0;
    for (int trial = 0; trial < kTrials; ++trial, t *= kShorter) {
        to.x = from.x + t * d;
        if (surface)
            to.freedom = guide_.admit(vertex, to.x, hint);
        const double limit = from.energy + kSufficient * t * slope;
        to.energy = energy_.at(star_, to.x, &to.gradient, limit);
        if (to.energy > limit)
            continue;
        if (surface && !watch_.allows(to.x)) {
            if (++refused == kRefusals)
                return false;
            // Mostly the tolerance is in the way: a step along the surface may gain as much.
            if (refused == 1 && from.freedom.kind == Freedom::Kind::space && slide(from.gradient, d, slope))
                t /= kShorter; // the next trial takes as long a step
            continue;
        }
        if (surface)
            add_watched(to);
        if (to.energy <= limit) {
            to.gradient = to.freedom.of(to.gradient);
            return true;
        }
    }
    return false;
}

bool VertexDescent::relax(int v, int steps) {
    const Vertex &vertex = complex_.vertex(v);
    std::int32_t hint = vertex.hint;
    Place at;
    if (!movable(v) || !complex_.used(v) || !start(v, hint, at))
        return false;
    const double length = neighbour_distance(v);
    const double steepness = norm(at.gradient);
    if (steepness * length < kLevel)
        return false;
    const double before = at.energy;
    energy::InverseHessian3 inverse(kFirst * length / steepness);
    for (int step = 0; step < steps && at.energy > 0.0; ++step) {
        Place next;
        if (!step_down(vertex, at, at.freedom.of(-1.0 * (inverse * at.gradient)), length, hint, next))
            break;
        inverse.learn(next.x - at.x, next.gradient - at.gradient, step == 0);
        const double drop = at.energy - next.energy;
        at = next;
        if (drop < kWorth * before)
            break;
    }
    complex_.set_hint(v, hint);
    return at.energy < before && settle(v, at.x);
}

bool VertexDescent::nudge(int v, const Vec3 &x) {
    const Vertex &vertex = complex_.vertex(v);
    if (!movable(v) || !complex_.used(v))
        return false;
    constexpr int trials = 3;
    constexpr double shorter = 0.4; // what a step that is refused is shortened to
    const bool surface = vertex.stratum != Stratum::interior;
    if (surface)
        watch_.gather(v);
    energy_.gather(complex_, v, star_);
    Vec3 step = x - vertex.position;
    for (int trial = 0; trial < trials; ++trial, step = shorter * step) {
        Vec3 place = vertex.position + step;
        if (surface)
            guide_.admit(vertex, place);
        if (energy_.at(star_, place, nullptr) < kInfinity && (!surface || watch_.allows(place)))
            return settle(v, place);
    }
    return false;
}

} // namespace wct::search
