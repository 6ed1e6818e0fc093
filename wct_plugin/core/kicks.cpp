#include "kicks.h"

#include <algorithm>
#include <limits>

namespace wct {

void Kicks::ball(const Vec3 &center, double radius, int vertex, std::vector<int> &out) {
    out.assign(1, vertex);
    marks_.resize(complex_.vertex_slots(), 0);
    marks_[vertex] = ++mark_;
    for (std::size_t k = 0; k < out.size(); ++k)
        for (int t : complex_.star(out[k]))
            for (int w : complex_.tet(t))
                if (marks_[w] != mark_) {
                    marks_[w] = mark_;
                    if (norm(complex_.point(w) - center) < radius)
                        out.push_back(w);
                }
}

void Kicks::shake(int t, const Kick &kick) {
    const Tet tet = complex_.tet(t);
    const Vec3 center =
        0.25 * (complex_.point(tet[0]) + complex_.point(tet[1]) + complex_.point(tet[2]) + complex_.point(tet[3]));
    std::vector<int> vertices;
    ball(center, kick.radius * complex_.vertex(tet[0]).size, tet[0], vertices);
    operators_.touched = vertices;
    for (int v : tet)
        operators_.touch(v);
    vertices = operators_.touched;
    for (int v : vertices)
        if (random_.coin())
            descent_.nudge(v, complex_.point(v) + (kick.sigma * complex_.vertex(v).size) * random_.normal3());
    for (int k = 0; k < kick.operators; ++k) {
        const int v = operators_.touched[random_.below(static_cast<int>(operators_.touched.size()))];
        if (complex_.used(v))
            repair_.random_operator(complex_.star(v)[random_.below(static_cast<int>(complex_.star(v).size()))],
                                    kick.slack);
    }
    for (int round = 0; round < 3; ++round) {
        vertices = operators_.touched;
        for (int v : vertices)
            descent_.relax(v, 3);
        repair_.flip_round(vertices);
    }
}

void Kicks::near_changed(const Vec3 &center, double radius) {
    constexpr std::size_t most = 48; // where much falls short, all of it within the radius would be a sweep of its own
    complex_.changed(changed_);
    nearest_.clear();
    for (int t : changed_) {
        if (!complex_.alive(t) || complex_.energy(t) <= 0.0)
            continue;
        const double distance = norm(complex_.point(complex_.tet(t)[0]) - center);
        if (distance <= radius)
            nearest_.push_back({distance, t});
    }
    std::sort(nearest_.begin(), nearest_.end());
    nearest_.resize(std::min(nearest_.size(), most));
    changed_.clear();
    for (const auto &[distance, t] : nearest_)
        changed_.push_back(t);
}

bool Kicks::repair(const Kick &kick, const Vec3 &center, double radius) {
    double previous = std::numeric_limits<double>::infinity();
    const int rounds = kick.wide ? 7 : 4;
    for (int round = 0; round < rounds; ++round) {
        near_changed(center, radius);
        repair_.pass(Repair::recipes[kick.wide ? round % 3 : std::min(round, 2)], changed_);
        const double gain = complex_.gain();
        if (kick.wide ? (round >= 1 && gain > 6.0) || (round >= 3 && gain > 1.2)
                      : (round >= 1 && gain > 1.5) || (round >= 2 && gain > 0.3))
            return false;
        if (round > (kick.wide ? 4 : 1) && gain > previous - 1e-3)
            break;
        previous = gain;
    }
    return complex_.gain() < 0.02;
}

bool Kicks::once() {
    static constexpr Kick kicks[] = {
        {1.0, 0.12, 2, 4.0, false},  {1.4, 0.2, 4, 6.0, false},  {0.9, 0.3, 4, 10.0, false}, {1.7, 0.3, 8, 8.0, false},
        {1.6, 0.35, 14, 30.0, true}, {2.2, 0.3, 16, 20.0, true}, {2.8, 0.25, 28, 20.0, true}};
    constexpr int patience = 40; // failures before the next wide kick joins in
    constexpr int small = 4;
    const int t = agenda_.next();
    const int failures = agenda_.failures(t);
    const int choices = std::min<int>(std::size(kicks), small + failures / patience);
    const Kick &kick = kicks[random_.below(choices)];
    const Tet tet = complex_.tet(t);
    const Vec3 center =
        0.25 * (complex_.point(tet[0]) + complex_.point(tet[1]) + complex_.point(tet[2]) + complex_.point(tet[3]));
    const double radius = (kick.wide ? 4.6 : 3.5) * complex_.vertex(tet[0]).size;
    complex_.mark();
    shake(t, kick);
    if (!repair(kick, center, radius)) {
        complex_.rollback();
        agenda_.failed(t);
        return false;
    }
    const bool better = complex_.gain() < -1e-3;
    complex_.changed(changed_);
    complex_.commit();
    agenda_.update(changed_, better ? failures / 2 : failures + 1);
    if (!better)
        agenda_.failed(t);
    return better;
}

} // namespace wct
