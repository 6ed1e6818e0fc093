#include "search/search_energy.h"

#include "base/lane_extremes.h"
#include "base/multiversion.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace wct::search {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// kFacets turned round, so that (corner, facet) is a positive tet.
void load_star_tet(const TetComplex &complex, const Tet &tet, int v, energy::TetLanes &lanes, int lane) {
    int i = 0;
    while (tet[i] != v)
        ++i;
    lanes.set(lane, 0, complex.point(v));
    lanes.set(lane, 1, complex.point(tet[kFacets[i][0]]));
    lanes.set(lane, 2, complex.point(tet[kFacets[i][2]]));
    lanes.set(lane, 3, complex.point(tet[kFacets[i][1]]));
}

void load_tet(const TetComplex &complex, const Tet &tet, energy::TetLanes &lanes, int lane) {
    for (int i = 0; i < 4; ++i)
        lanes.set(lane, i, complex.point(tet[i]));
}

} // namespace

// The twelve angles are written out: with a loop over them the compiler goes across them instead of along the lanes.
WCT_MULTIVERSION
static void add_needles(const energy::ShapeLanes &shape, const energy::Lanes &least, double weight,
                        energy::Lanes &energy) {
    const energy::ShapeLanes *__restrict in = &shape;
    const energy::Lanes *__restrict bound = &least;
    energy::Lanes *__restrict out = &energy;
    for (int lane = 0; lane < energy::kLanes; ++lane) {
        double sum = 0.0;
#pragma GCC unroll 12
        for (int k = 0; k < 12; ++k) {
            const double over = larger(0.0, in->cosine[k].at[lane] - bound->at[lane]);
            sum += over * over;
        }
        out->at[lane] += weight * sum;
    }
}

WCT_MULTIVERSION
static void add_needle_slopes(const energy::ShapeLanes &shape, const energy::Lanes &least, double weight,
                              energy::SlopeLanes &slopes) {
    const energy::ShapeLanes *__restrict in = &shape;
    const energy::Lanes *__restrict bound = &least;
    energy::SlopeLanes *__restrict out = &slopes;
    for (int lane = 0; lane < energy::kLanes; ++lane)
#pragma GCC unroll 12
        for (int k = 0; k < 12; ++k)
            out->cosine[k].at[lane] += 2.0 * weight * larger(0.0, in->cosine[k].at[lane] - bound->at[lane]);
}

WCT_MULTIVERSION
static void add_counts(const energy::ShapeLanes &shape, const SearchForm &form, energy::Lanes &energy) {
    const energy::ShapeLanes *__restrict in = &shape;
    energy::Lanes *__restrict out = &energy;
    const double clearance = form.clearance, count = form.count;
    const double hard_clearance = form.hard_clearance, hard_count = form.hard_count;
    energy::Lanes worst;
    for (int lane = 0; lane < energy::kLanes; ++lane)
        worst.at[lane] = smaller(smaller(in->height[0].at[lane], in->height[1].at[lane]),
                                 smaller(in->height[2].at[lane], in->height[3].at[lane]));
    if (form.shape.cosines())
        for (int lane = 0; lane < energy::kLanes; ++lane) {
            double least = worst.at[lane];
#pragma GCC unroll 12
            for (int k = 0; k < 12; ++k)
                least = smaller(least, in->cosine[k].at[lane]);
            worst.at[lane] = least;
        }
    for (int lane = 0; lane < energy::kLanes; ++lane)
        out->at[lane] +=
            (worst.at[lane] <= clearance ? count : 0.0) + (worst.at[lane] <= hard_clearance ? hard_count : 0.0);
}

bool SearchEnergy::evaluate(const energy::TetLanes &tets, const SearchTerms &terms, energy::Lanes &energy,
                            energy::Lanes *gradient, bool count, int used, double limit) const {
    const bool cosines = form_.shape.cosines() || form_.needle_weight != 0.0;
    energy::ShapeLanes shape;
    energy::SlopeLanes slopes;
    energy::measure(tets, cosines, shape);
    if (gradient) {
        if (cosines && form_.shape.weight2 == 0.0)
            for (energy::Lanes &slope : slopes.cosine)
                slope = energy::Lanes{};
        energy::penalize(shape, form_.shape, terms.bounds, energy, slopes);
    } else {
        energy::penalize(shape, form_.shape, terms.bounds, energy);
    }
    if (form_.needle_weight != 0.0) {
        add_needles(shape, terms.needle, form_.needle_weight, energy);
        if (gradient)
            add_needle_slopes(shape, terms.needle, form_.needle_weight, slopes);
    }
    if (count)
        add_counts(shape, form_, energy);
    evaluations_ += energy::kLanes;
    const double sum = std::accumulate(energy.at, energy.at + used, 0.0);
    if (!(sum <= limit))
        return false;
    if (gradient && sum > 0.0)
        energy::differentiate_first(tets, shape, slopes, cosines, gradient);
    else if (gradient)
        std::fill(gradient, gradient + 3, energy::Lanes{}); // where there is no energy there is no slope
    return true;
}

double SearchEnergy::smooth(const energy::TetLanes &tets, const SearchTerms &terms, int used, double limit,
                            energy::GradientLanes &gradient) const {
    constexpr double margin = 0.06;
    const bool acute = form_.shape.cosines();
    const energy::EnergyForm form{.margin3 = margin,
                                  .power3 = 2.0,
                                  .margin2 = margin,
                                  .power2 = 2.0,
                                  .weight2 = acute ? 1.0 : 0.0,
                                  .weight_quality = 0.0};
    energy::ShapeLanes shape;
    energy::SlopeLanes slopes;
    energy::Lanes energy;
    energy::measure(tets, true, shape);
    if (!acute)
        for (energy::Lanes &slope : slopes.cosine)
            slope = energy::Lanes{};
    energy::penalize(shape, form, terms.bounds, energy, slopes);
    add_needles(shape, terms.needle, form_.needle_weight, energy);
    evaluations_ += energy::kLanes;
    const double sum = std::accumulate(energy.at, energy.at + used, 0.0);
    if (sum > 0.0 && sum <= limit) {
        add_needle_slopes(shape, terms.needle, form_.needle_weight, slopes);
        energy::differentiate(tets, shape, slopes, true, gradient);
    }
    return sum;
}

void SearchEnergy::of(const TetComplex &complex, std::span<const Tet> tets, double *energies) const {
    of(complex, tets, energy::kDegenerate, energies);
}

void SearchEnergy::of_present(const TetComplex &complex, std::span<const Tet> tets, double *energies) const {
    of(complex, tets, -kInfinity, energies);
}

double SearchEnergy::of_present(const TetComplex &complex, const Tet &tet) const {
    double energy = 0.0;
    of_present(complex, {&tet, 1}, &energy);
    return energy;
}

void SearchEnergy::of(const TetComplex &complex, std::span<const Tet> tets, double flattest, double *energies) const {
    energy::TetLanes lanes;
    SearchTerms terms{energy::flatness_terms(flattest), {}};
    energy::Lanes energy;
    for (std::size_t begin = 0; begin < tets.size(); begin += energy::kLanes) {
        const int used = static_cast<int>(std::min<std::size_t>(energy::kLanes, tets.size() - begin));
        for (int lane = 0; lane < energy::kLanes; ++lane) {
            const Tet &tet = tets[begin + (lane < used ? lane : 0)];
            load_tet(complex, tet, lanes, lane);
            terms.needle[lane] = needle(complex, tet);
        }
        evaluate(lanes, terms, energy, nullptr, true);
        for (int lane = 0; lane < used; ++lane)
            energies[begin + lane] = energy[lane] + over(complex, tets[begin + lane]);
    }
}

bool SearchEnergy::positive(const TetComplex &complex, const Tet &tet) {
    const Vec3 &o = complex.point(tet[0]);
    return dot(complex.point(tet[1]) - o, cross(complex.point(tet[2]) - o, complex.point(tet[3]) - o)) > 0.0;
}

bool SearchEnergy::below(const TetComplex &complex, std::span<const Tet> tets, double limit, double *energies) const {
    for (const Tet &tet : tets) // most changes that fail invert a tet, and that is cheap to see
        if (!positive(complex, tet))
            return false;
    double sum = 0.0;
    for (std::size_t begin = 0; begin < tets.size(); begin += energy::kLanes) {
        const std::size_t used = std::min<std::size_t>(energy::kLanes, tets.size() - begin);
        of(complex, tets.subspan(begin, used), energies + begin);
        for (std::size_t k = begin; k < begin + used; ++k)
            sum += energies[k];
        if (!(sum < limit)) // no energy is negative
            return false;
    }
    return true;
}

energy::TermLanes SearchEnergy::present_bounds(const energy::TetLanes &tets) {
    constexpr double kFlatter = 0.999; // than it is, by rounding
    energy::TermLanes terms = energy::flatness_terms(energy::kDegenerate);
    energy::WorstLanes worst;
    energy::measure_worst(tets, false, worst);
    for (int lane = 0; lane < energy::kLanes; ++lane)
        if (worst.flatness[lane] <= energy::kDegenerate)
            terms.flatness[lane] = kFlatter * worst.flatness[lane];
    return terms;
}

double SearchEnergy::needle(const TetComplex &complex, const Tet &tet) {
    return std::max({complex.vertex(tet[0]).needle, complex.vertex(tet[1]).needle, complex.vertex(tet[2]).needle,
                     complex.vertex(tet[3]).needle});
}

void SearchEnergy::gather(const TetComplex &complex, int v, StarLanes &star) const {
    star.tets = complex.star(v);
    complex.sort_worst_first(star.tets);
    const std::vector<int> &tets = star.tets;
    const std::size_t groups = (tets.size() + energy::kLanes - 1) / energy::kLanes;
    star.lanes.resize(groups);
    star.terms.resize(groups);
    for (std::size_t g = 0; g < groups; ++g) {
        for (int lane = 0; lane < energy::kLanes; ++lane) {
            const std::size_t k = g * energy::kLanes + lane;
            const Tet &tet = complex.tet(tets[k < tets.size() ? k : g * energy::kLanes]);
            load_star_tet(complex, tet, v, star.lanes[g], lane);
            star.terms[g].needle[lane] = needle(complex, tet);
        }
        star.terms[g].bounds = present_bounds(star.lanes[g]);
    }
}

double SearchEnergy::at(StarLanes &star, const Vec3 &x, Vec3 *gradient, double limit) const {
    double sum = 0.0;
    if (gradient)
        *gradient = {};
    for (std::size_t g = 0; g < star.lanes.size(); ++g) {
        star.lanes[g].set_all(0, x);
        energy::Lanes energy;
        energy::Lanes slope[3];
        const int used = star.used(g);
        if (!evaluate(star.lanes[g], star.terms[g], energy, gradient ? slope : nullptr, false, used, limit - sum))
            return kInfinity; // no energy is negative
        for (int lane = 0; lane < used; ++lane) {
            sum += energy[lane];
            if (gradient)
                *gradient += {slope[0][lane], slope[1][lane], slope[2][lane]};
        }
    }
    return sum;
}

void SearchEnergy::each(StarLanes &star, const Vec3 &x, double *energies) const {
    for (std::size_t g = 0; g < star.lanes.size(); ++g) {
        star.lanes[g].set_all(0, x);
        energy::Lanes energy;
        evaluate(star.lanes[g], star.terms[g], energy, nullptr, true);
        const int used = star.used(g);
        for (int lane = 0; lane < used; ++lane)
            energies[g * energy::kLanes + lane] = energy[lane];
    }
}

} // namespace wct::search
