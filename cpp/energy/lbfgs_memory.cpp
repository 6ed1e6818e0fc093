#include "energy/lbfgs_memory.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wct::energy {

double inner(const Field &a, const Field &b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += dot(a[i], b[i]);
    return sum;
}

void add(Field &a, double s, const Field &b) {
    for (std::size_t i = 0; i < a.size(); ++i)
        a[i] += s * b[i];
}

double longest(const Field &a) {
    double most = 0.0;
    for (const Vec3 &v : a)
        most = std::max(most, dot(v, v));
    return std::sqrt(most);
}

void LbfgsMemory::remember(Field step, Field change) {
    constexpr double least = 1e-12; // curvature below this, relative to the gradient's change, is noise
    const double curve = inner(step, change);
    if (!(curve > least * inner(change, change)))
        return;
    pairs_.push_back({std::move(step), std::move(change), 1.0 / curve});
    if (pairs_.size() > most_)
        pairs_.pop_front();
}

void LbfgsMemory::remember(const Field &from, const Field &to, const Field &gradient, const Field &slope) {
    Field step = to, change = slope;
    add(step, -1.0, from);
    add(change, -1.0, gradient);
    remember(std::move(step), std::move(change));
}

Field LbfgsMemory::direction(const Field &gradient) const {
    Field d = gradient;
    std::vector<double> alpha(pairs_.size());
    for (std::size_t k = pairs_.size(); k-- > 0;) {
        alpha[k] = pairs_[k].scale * inner(pairs_[k].step, d);
        add(d, -alpha[k], pairs_[k].change);
    }
    const Pair &last = pairs_.back();
    const double gamma = 1.0 / (last.scale * inner(last.change, last.change));
    for (Vec3 &v : d)
        v = gamma * v;
    for (std::size_t k = 0; k < pairs_.size(); ++k)
        add(d, alpha[k] - pairs_[k].scale * inner(pairs_[k].change, d), pairs_[k].step);
    for (Vec3 &v : d)
        v = -1.0 * v;
    return d;
}

} // namespace wct::energy
