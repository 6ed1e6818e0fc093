#include "sampling/cloud_descent.h"

#include "base/sort_unique.h"
#include "energy/lbfgs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace wct::sampling {

namespace {

constexpr double kSteeper = 0.98; // share of the points that the steepest descent is scaled by
constexpr double kFirst = 0.3;    // longest step along it, in shares of the longest of all

/// Shorten every point's step to `reach` sizes.
void clip(energy::Field &step, double reach) {
    for (Vec3 &v : step) {
        const double far = norm(v);
        if (far > reach)
            v = (reach / far) * v;
    }
}

/// Against the gradient. The few steepest points, which sit in nearly flat tets, do not set the scale for the rest.
energy::Field steepest(const energy::Field &gradient, double reach) {
    std::vector<double> slopes(gradient.size());
    for (std::size_t i = 0; i < gradient.size(); ++i)
        slopes[i] = norm(gradient[i]);
    const auto at = slopes.begin() + static_cast<std::ptrdiff_t>(kSteeper * static_cast<double>(slopes.size()));
    std::nth_element(slopes.begin(), at, slopes.end());
    const double scale = *at > 0.0 ? *at : *std::max_element(slopes.begin(), slopes.end());
    energy::Field step = gradient;
    for (Vec3 &v : step)
        v = (scale > 0.0 ? -kFirst * reach / scale : 0.0) * v;
    clip(step, kFirst * reach);
    return step;
}

/// Tets from the `first` on into lanes, the last one again where there are no more.
void load(const energy::Field &points, const std::vector<Tet> &tets, std::size_t first, energy::TetLanes &lanes) {
    for (std::size_t lane = 0; lane < energy::kLanes; ++lane) {
        const Tet &tet = tets[std::min(first + lane, tets.size() - 1)];
        for (int k = 0; k < 4; ++k)
            lanes.set(static_cast<int>(lane), k, points[tet[k]]);
    }
}

/// The tets of all regions.
std::vector<Tet> tets_inside(const RestrictedDelaunay &complex) {
    std::vector<Tet> tets;
    for (std::size_t t = 0; t < complex.all.tets.size(); ++t)
        if (complex.region[t] >= 0)
            tets.push_back(complex.all.tets[t]);
    return tets;
}

/// The points of a cloud, for L-BFGS, in units of their sizes: there the energy is equally stiff everywhere, however
/// the sizes vary.
class Objective {
  public:
    Objective(const Cloud &cloud, const RestrictedDelaunay &complex, const std::vector<Vec3> &direction,
              const energy::EnergyForm &form, const EdgeForm &edges, const std::vector<char> &curved,
              const FitForm &fit, const std::vector<Tie> &ties, double reach, const Workers &workers)
        : cloud_(cloud), direction_(direction), form_(form), edge_form_(edges), fit_(fit), ties_(ties), reach_(reach),
          workers_(workers), scaled_(cloud.points) {
        for (std::size_t i = 0; i < scaled_.size(); ++i)
            scaled_[i] = (1.0 / cloud.size[i]) * scaled_[i];
        next_ = scaled_;
        if (edges.weight > 0.0)
            for (const auto &edge : surface_edges(complex))
                if (curved[edge[0]] && curved[edge[1]])
                    edges_.push_back(edge);
        tets_ = tets_inside(complex);
        std::erase_if(tets_, [&](const Tet &tet) {
            return std::all_of(tet.begin(), tet.end(), [&](int v) { return cloud.held[v] == Hold::all; });
        });
        // Next to nothing is left of a tet as flat as this: it is for the next triangulation to deal with, and must not
        // make the energy infinite before anything has moved.
        constexpr double kHopeless = 2e-2;
        energy::TetLanes lanes;
        energy::WorstLanes worst;
        std::vector<Tet> kept;
        for (std::size_t first = 0; first < tets_.size(); first += energy::kLanes) {
            load(cloud.points, tets_, first, lanes);
            energy::measure_worst(lanes, false, worst);
            for (std::size_t k = first; k < std::min(first + energy::kLanes, tets_.size()); ++k) {
                const double flatness = worst.flatness[static_cast<int>(k - first)];
                if (flatness < kHopeless)
                    continue;
                kept.push_back(tets_[k]);
                // A tet that is degenerate already may stay so, but not turn inside out.
                floors_.push_back(std::min(energy::kDegenerate, 0.5 * flatness));
                weights_.push_back(between_held(cloud, tets_[k]) ? kBetweenHeld : 1.0);
            }
        }
        tets_ = std::move(kept);
    }

    double start(energy::Field &gradient) { return evaluate(gradient); }

    energy::Field downhill(const energy::Field &gradient) const { return steepest(gradient, reach_); }

    void restrain(energy::Field &step) const {
        project(step);
        clip(step, reach_);
    }

    double share(const energy::Field &) const { return 1.0; }

    double attempt(double share, const energy::Field &step, double, energy::Field &gradient) {
        next_ = scaled_;
        energy::add(next_, share, step);
        return evaluate(gradient);
    }

    /// A few tets are in the way: their corners hold back, the rest of the mesh goes on.
    bool yields(energy::Field &step) {
        if (blocked_.empty())
            return false;
        sort_unique(blocked_);
        for (const int v : blocked_)
            step[v] = kHeldBack * step[v];
        return true;
    }

    bool goes_on(int) const { return true; }

    void accept(energy::LbfgsMemory &memory, const energy::Field &gradient, const energy::Field &slope) {
        memory.remember(scaled_, next_, gradient, slope);
        std::swap(scaled_, next_);
    }

    /// Where the point stands.
    Vec3 point(std::size_t i) const { return cloud_.size[i] * scaled_[i]; }
    std::size_t evaluations() const { return evaluations_; }

  private:
    static constexpr std::size_t kTogether = 512; // tets that one thread measures together
    static constexpr double kSteep = 0.5;
    static constexpr double kHeldBack = 0.25; // share of its step left to a point in whose way a tet is
    /// How often a tet between points that relaxation holds counts. Where they are held here too the tets beside them
    /// stay bad; where all count alike, those beside them make them bad, and they are the harder ones to mend.
    static constexpr double kBetweenHeld = 6.0;

    static bool between_held(const Cloud &cloud, const Tet &tet) {
        return std::all_of(tet.begin(), tet.end(), [&](int v) { return cloud.held[v] == Hold::relaxation; });
    }

    /// At `next_`. Infinite where a tet would become degenerate; `blocked_` then holds the corners of all such tets.
    double evaluate(energy::Field &gradient) {
        points_.resize(next_.size());
        for (std::size_t i = 0; i < next_.size(); ++i)
            points_[i] = cloud_.size[i] * next_[i];
        gradient.assign(points_.size(), {});
        double sum = 0.0;
        add_tets(sum, gradient);
        if (!blocked_.empty())
            return std::numeric_limits<double>::infinity();
        add_edges(sum, gradient);
        add_ties(sum, gradient);
        for (std::size_t i = 0; i < gradient.size(); ++i)
            gradient[i] = cloud_.size[i] * gradient[i];
        project(gradient);
        return sum;
    }

    /// Energies of some tets and their gradients, a group of lanes after the other.
    struct Part {
        std::vector<energy::Lanes> energy;
        std::vector<energy::GradientLanes> gradient;
    };

    void add_tets(double &sum, energy::Field &gradient) {
        blocked_.clear();
        evaluations_ += tets_.size();
        workers_.in_order<Part>(
            tets_.size(), kTogether,
            [this](std::size_t begin, std::size_t end, Part &part) { measure_tets(begin, end, part); },
            [&](std::size_t begin, std::size_t end, const Part &part) {
                for (std::size_t t = begin; t < end; ++t) {
                    const std::size_t group = (t - begin) / energy::kLanes;
                    const int l = static_cast<int>((t - begin) % energy::kLanes);
                    if (!(part.energy[group][l] < std::numeric_limits<double>::infinity()))
                        blocked_.insert(blocked_.end(), tets_[t].begin(), tets_[t].end());
                    sum += weights_[t] * part.energy[group][l];
                    const auto &corner = part.gradient[group].corner;
                    for (int k = 0; k < 4; ++k)
                        gradient[tets_[t][k]] += weights_[t] * Vec3{corner[k][0][l], corner[k][1][l], corner[k][2][l]};
                }
            });
    }

    void measure_tets(std::size_t begin, std::size_t end, Part &part) const {
        const bool cosines = form_.weight2 > 0.0;
        const std::size_t groups = (end - begin + energy::kLanes - 1) / energy::kLanes;
        part.energy.resize(groups);
        part.gradient.resize(groups);
        energy::TetLanes lanes;
        energy::TermLanes terms = energy::flatness_terms(0.0);
        energy::ShapeLanes shape;
        energy::SlopeLanes slopes;
        for (std::size_t group = 0, first = begin; group < groups; ++group, first += energy::kLanes) {
            load(points_, tets_, first, lanes);
            for (int lane = 0; lane < energy::kLanes; ++lane)
                terms.flatness[lane] = floors_[std::min(first + static_cast<std::size_t>(lane), tets_.size() - 1)];
            energy::measure(lanes, cosines, shape);
            energy::penalize(shape, form_, terms, part.energy[group], slopes);
            energy::differentiate(lanes, shape, slopes, cosines, part.gradient[group]);
        }
    }

    void add_edges(double &sum, energy::Field &gradient) const {
        for (const auto &[v, w] : edges_) {
            const Vec3 d = points_[v] - points_[w];
            const double limit = 0.5 * edge_form_.limit * (cloud_.size[v] + cloud_.size[w]);
            const double length = norm(d);
            if (length <= limit)
                continue;
            const double over = length / limit - 1.0;
            sum += edge_form_.weight * over * over;
            const Vec3 pull = (2.0 * edge_form_.weight * over / (limit * length)) * d;
            gradient[v] += pull;
            gradient[w] -= pull;
        }
    }

    void add_ties(double &sum, energy::Field &gradient) const {
        for (const Tie &tie : ties_) {
            const auto &[a, b, c] = tie.corner;
            const auto &[u, v, w] = tie.weight;
            const double height = dot(tie.normal, u * points_[a] + v * points_[b] + w * points_[c]) - tie.level;
            const double over = std::fabs(height) / fit_.limit - 1.0;
            if (over <= 0.0)
                continue;
            // Quadratic at first, then linear: what is out of reach does not drown the rest.
            const double slope = 2.0 * std::min(over, kSteep);
            sum += fit_.weight * slope * (over - 0.25 * slope);
            const Vec3 pull = (std::copysign(fit_.weight * slope, height) / fit_.limit) * tie.normal;
            gradient[a] += u * pull;
            gradient[b] += v * pull;
            gradient[c] += w * pull;
        }
    }

    /// The part of a field along which the points may move.
    void project(energy::Field &field) const {
        for (std::size_t i = 0; i < field.size(); ++i)
            switch (cloud_.held[i] >= Hold::descent ? Stratum::corner : cloud_.role[i]) {
            case Stratum::interior:
                break;
            case Stratum::patch:
                field[i] -= dot(field[i], direction_[i]) * direction_[i];
                break;
            case Stratum::crease:
                field[i] = dot(field[i], direction_[i]) * direction_[i];
                break;
            case Stratum::corner:
                field[i] = {};
                break;
            }
    }

    const Cloud &cloud_;
    const std::vector<Vec3> &direction_;
    const energy::EnergyForm &form_;
    const EdgeForm &edge_form_;
    const FitForm &fit_;
    const std::vector<Tie> &ties_;
    std::vector<Edge> edges_;
    std::vector<Tet> tets_;
    std::vector<double> floors_, weights_;
    double reach_;
    const Workers &workers_;
    energy::Field scaled_, next_; // where the points stand, and were tried last, in units of their sizes
    energy::Field points_;        // where they were tried last
    std::vector<int> blocked_;
    std::size_t evaluations_ = 0;
};

} // namespace

Tally count_bad(const Cloud &cloud, const RestrictedDelaunay &complex, bool cosines) {
    Tally tally;
    energy::TetLanes lanes;
    energy::WorstLanes worst;
    int filled = 0;
    const auto flush = [&] {
        if (!filled)
            return;
        energy::measure_worst(lanes, cosines, worst);
        for (int l = 0; l < filled; ++l) {
            tally.bad += !(worst.height[l] > 0.0 && (!cosines || worst.cosine[l] > 0.0));
            tally.worst_height = std::min(tally.worst_height, worst.height[l]);
        }
        filled = 0;
    };
    for (std::size_t t = 0; t < complex.all.tets.size(); ++t) {
        if (complex.region[t] < 0)
            continue;
        ++tally.tets;
        for (int k = 0; k < 4; ++k)
            lanes.set(filled, k, cloud.points[complex.all.tets[t][k]]);
        if (filled == 0) // spare lanes must hold something harmless
            for (int l = 1; l < energy::kLanes; ++l)
                for (int k = 0; k < 4; ++k)
                    lanes.set(l, k, cloud.points[complex.all.tets[t][k]]);
        if (++filled == energy::kLanes)
            flush();
    }
    flush();
    return tally;
}

std::vector<char> points_to_move(const Cloud &cloud, const RestrictedDelaunay &complex, energy::EnergyForm form,
                                 int rings) {
    form.weight_quality = 0.0;
    const std::vector<Tet> tets = tets_inside(complex);
    std::vector<char> moves(cloud.count());
    for (std::size_t i = 0; i < moves.size(); ++i)
        moves[i] = cloud.role[i] != Stratum::interior;
    energy::TetLanes lanes;
    energy::ShapeLanes shape;
    energy::SlopeLanes slopes;
    energy::Lanes energy;
    const energy::TermLanes terms = energy::flatness_terms(0.0);
    for (std::size_t first = 0; first < tets.size(); first += energy::kLanes) {
        load(cloud.points, tets, first, lanes);
        energy::measure(lanes, form.cosines(), shape);
        energy::penalize(shape, form, terms, energy, slopes);
        for (std::size_t k = first; k < std::min(first + energy::kLanes, tets.size()); ++k)
            if (!(energy[static_cast<int>(k - first)] <= 0.0))
                for (const int v : tets[k])
                    moves[v] = 1;
    }
    for (int ring = 0; ring < rings; ++ring) {
        const std::vector<char> before = moves;
        for (const Tet &tet : tets)
            if (std::any_of(tet.begin(), tet.end(), [&](int v) { return before[v]; }))
                for (const int v : tet)
                    moves[v] = 1;
    }
    return moves;
}

std::size_t descend(Cloud &cloud, const RestrictedDelaunay &complex, const std::vector<Vec3> &direction,
                    const energy::EnergyForm &form, const EdgeForm &edges, const std::vector<char> &curved,
                    const FitForm &fit, const std::vector<Tie> &ties, const Course &course, const Workers &workers) {
    constexpr energy::LbfgsForm lbfgs{.memory = 8, .trials = 15, .shorter = 0.5, .worth = 1e-9, .failures = 2};
    Objective objective(cloud, complex, direction, form, edges, curved, fit, ties, course.reach, workers);
    energy::LbfgsForm asked = lbfgs;
    asked.iterations = course.iterations;
    energy::descend(objective, asked);
    for (std::size_t i = 0; i < cloud.count(); ++i)
        if (cloud.held[i] < Hold::all) // not by a rounding
            cloud.points[i] = objective.point(i);
    return objective.evaluations();
}

} // namespace wct::sampling
