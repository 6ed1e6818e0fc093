// Energies from shapes: the one-sided penalties and their slopes.

#include "base/lane_extremes.h"
#include "base/multiversion.h"
#include "energy/energy.h"

#include <cmath>
#include <limits>

namespace wct::energy {

namespace {

/// d^(twice/2) and its derivative for d >= 0: only multiplications and square roots, so the same bits everywhere.
template <int twice> WCT_INLINE void half_power(double d, double &value, double &slope) {
    double below = twice % 2 ? std::sqrt(d) : 1.0; // becomes d^(twice/2 - 1)
    if constexpr (twice == 2) {
        value = d;
        slope = d > 0.0 ? 1.0 : 0.0;
        return;
    }
    for (int k = 0; k < twice / 2 - 1; ++k)
        below *= d;
    value = below * d;
    slope = 0.5 * twice * below;
}

/// What a penalty reads and writes, four values per tet: `factor` scales the slopes, and where it is zero so are they.
/// No slopes are written where `slopes` is null.
struct Penalty {
    const Lanes *values;
    const Lanes *factor;
    double margin;
    double weight;
    double quality;
    Lanes *energy;
    Lanes *slopes;
};

/// Adds weight * max(0, margin - value)^(twice/2) + quality * (value - 1/3)^2 to the energy and writes its slopes.
template <int twice, bool sloped, bool with_quality> WCT_INLINE void hinge_half(const Penalty &penalty) {
    const Lanes *__restrict values = penalty.values;
    const Lanes *__restrict factor = penalty.factor;
    Lanes *__restrict energy = penalty.energy;
    Lanes *__restrict slopes = penalty.slopes;
    const double margin = penalty.margin;
    const double weight = penalty.weight;
    const double quality = penalty.quality;
    for (int lane = 0; lane < kLanes; ++lane) {
        [[maybe_unused]] const double scale = factor->at[lane];
        double sum = 0.0;
        for (int i = 0; i < 4; ++i) {
            double value = 0.0;
            double slope = 0.0;
            half_power<twice>(larger(0.0, margin - values[i].at[lane]), value, slope);
            double total = -weight * slope;
            sum += weight * value;
            if constexpr (with_quality) {
                const double off = values[i].at[lane] - 1.0 / 3.0;
                sum += quality * off * off;
                total += 2.0 * quality * off;
            }
            if constexpr (sloped)
                slopes[i].at[lane] = scale != 0.0 ? scale * total : 0.0;
        }
        energy->at[lane] += sum;
    }
}

/// The same for any power.
void hinge_any(const Penalty &penalty, double power) {
    for (int lane = 0; lane < kLanes; ++lane)
        for (int i = 0; i < 4; ++i) {
            const double d = penalty.margin - penalty.values[i][lane];
            const double below = d > 0.0 ? std::pow(d, power - 1.0) : 0.0;
            const double off = penalty.values[i][lane] - 1.0 / 3.0;
            penalty.energy->at[lane] += (d > 0.0 ? penalty.weight * below * d : 0.0) + penalty.quality * off * off;
            if (!penalty.slopes)
                continue;
            const double total = 2.0 * penalty.quality * off - penalty.weight * power * below;
            const double scale = penalty.factor->at[lane];
            penalty.slopes[i][lane] = scale != 0.0 ? scale * total : 0.0;
        }
}

template <bool sloped, bool with_quality> WCT_INLINE void hinge(const Penalty &penalty, double power) {
    if (power == 1.0)
        hinge_half<2, sloped, with_quality>(penalty);
    else if (power == 1.5)
        hinge_half<3, sloped, with_quality>(penalty);
    else if (power == 2.0)
        hinge_half<4, sloped, with_quality>(penalty);
    else if (power == 2.5)
        hinge_half<5, sloped, with_quality>(penalty);
    else if (power == 3.0)
        hinge_half<6, sloped, with_quality>(penalty);
    else
        hinge_any(penalty, power);
}

template <bool sloped>
WCT_INLINE void penalize_lanes(const ShapeLanes &shape, const EnergyForm &form, const TermLanes &terms, Lanes &energy,
                               SlopeLanes *slopes) {
    Lanes sum{};
    Lanes factor;
    for (int lane = 0; lane < kLanes; ++lane) {
        const double height = smaller(smaller(shape.height[0][lane], shape.height[1][lane]),
                                      smaller(shape.height[2][lane], shape.height[3][lane]));
        const bool sound = (shape.flatness[lane] > terms.flatness[lane]) & (height > terms.height[lane]);
        factor[lane] = sound ? 1.0 : 0.0;
    }
    if (form.cosines())
        for (int lane = 0; lane < kLanes; ++lane) {
            double least = shape.cosine[0].at[lane];
            for (int k = 1; k < 12; ++k)
                least = smaller(least, shape.cosine[k].at[lane]);
            factor[lane] = least > terms.cosine[lane] ? factor[lane] : 0.0;
        }
    Lanes broken;
    for (int lane = 0; lane < kLanes; ++lane) {
        broken[lane] = factor[lane] != 0.0 ? 0.0 : std::numeric_limits<double>::infinity();
        factor[lane] *= terms.weight[lane];
    }
    const Penalty heights{
        shape.height, &factor, form.margin3, 1.0, form.weight_quality, &sum, sloped ? slopes->height : nullptr};
    if (form.weight_quality != 0.0)
        hinge<sloped, true>(heights, form.power3);
    else
        hinge<sloped, false>(heights, form.power3);
    if (form.cosines())
        for (int k = 0; k < 12; k += 4)
            hinge<sloped, false>(Penalty{shape.cosine + k, &factor, form.margin2, form.weight2, 0.0, &sum,
                                         sloped ? slopes->cosine + k : nullptr},
                                 form.power2);
    for (int lane = 0; lane < kLanes; ++lane)
        energy[lane] = broken[lane] == 0.0 ? terms.weight[lane] * sum[lane] : broken[lane];
}

} // namespace

TermLanes flatness_terms(double flatness) {
    TermLanes terms;
    for (int lane = 0; lane < kLanes; ++lane) {
        terms.flatness[lane] = flatness;
        terms.height[lane] = terms.cosine[lane] = -std::numeric_limits<double>::infinity();
        terms.weight[lane] = 1.0;
    }
    return terms;
}

WCT_MULTIVERSION
void penalize(const ShapeLanes &shape, const EnergyForm &form, const TermLanes &terms, Lanes &energy,
              SlopeLanes &slopes) {
    penalize_lanes<true>(shape, form, terms, energy, &slopes);
}

WCT_MULTIVERSION
void penalize(const ShapeLanes &shape, const EnergyForm &form, const TermLanes &terms, Lanes &energy) {
    penalize_lanes<false>(shape, form, terms, energy, nullptr);
}

} // namespace wct::energy
