#include "search_energy.h"

#include <limits>

namespace wct {

namespace {

/// kFacets turned round, so that (corner, facet) is a positive tet.
void load_star_tet(const TetComplex &complex, const Tet &tet, int v, TetLanes &lanes, int lane) {
    int i = 0;
    while (tet[i] != v)
        ++i;
    lanes.set(lane, 0, complex.point(v));
    lanes.set(lane, 1, complex.point(tet[kFacets[i][0]]));
    lanes.set(lane, 2, complex.point(tet[kFacets[i][2]]));
    lanes.set(lane, 3, complex.point(tet[kFacets[i][1]]));
}

void load_tet(const TetComplex &complex, const Tet &tet, TetLanes &lanes, int lane) {
    for (int i = 0; i < 4; ++i)
        lanes.set(lane, i, complex.point(tet[i]));
}

} // namespace

void SearchEnergy::evaluate(const TetLanes &tets, const TermLanes &terms, Lanes &energy, Lanes *gradient,
                            bool count) const {
    const bool cosines = form_.shape.weight2 != 0.0 || form_.needle_weight != 0.0;
    ShapeLanes shape;
    SlopeLanes slopes;
    measure(tets, cosines, shape);
    if (cosines && form_.shape.weight2 == 0.0)
        for (Lanes &slope : slopes.cosine)
            slope = Lanes{};
    penalize(shape, form_.shape, terms, energy, slopes);
    if (form_.needle_weight != 0.0)
        for (int k = 0; k < 12; ++k)
            for (int lane = 0; lane < kLanes; ++lane) {
                const double over = shape.cosine[k][lane] - form_.needle_cosine;
                const double needle = over > 0.0 ? over : 0.0;
                energy[lane] += form_.needle_weight * needle * needle;
                slopes.cosine[k][lane] += 2.0 * form_.needle_weight * needle;
            }
    if (count) {
        Lanes worst = shape.height[0];
        for (int i = 1; i < 4; ++i)
            for (int lane = 0; lane < kLanes; ++lane)
                worst[lane] = worst[lane] < shape.height[i][lane] ? worst[lane] : shape.height[i][lane];
        if (form_.shape.weight2 != 0.0)
            for (int k = 0; k < 12; ++k)
                for (int lane = 0; lane < kLanes; ++lane)
                    worst[lane] = worst[lane] < shape.cosine[k][lane] ? worst[lane] : shape.cosine[k][lane];
        for (int lane = 0; lane < kLanes; ++lane)
            energy[lane] += (worst[lane] <= form_.clearance ? form_.count : 0.0) +
                            (worst[lane] <= form_.hard_clearance ? form_.hard_count : 0.0);
    }
    if (gradient)
        differentiate_first(tets, shape, slopes, cosines, gradient);
    evaluations_ += kLanes;
}

void SearchEnergy::of(const TetComplex &complex, std::span<const Tet> tets, double *energies) const {
    TetLanes lanes;
    const TermLanes terms = flatness_terms(kDegenerate);
    Lanes energy;
    for (std::size_t begin = 0; begin < tets.size(); begin += kLanes) {
        const int used = static_cast<int>(std::min<std::size_t>(kLanes, tets.size() - begin));
        for (int lane = 0; lane < kLanes; ++lane)
            load_tet(complex, tets[begin + (lane < used ? lane : 0)], lanes, lane);
        evaluate(lanes, terms, energy, nullptr, true);
        for (int lane = 0; lane < used; ++lane)
            energies[begin + lane] = energy[lane] + over(complex, tets[begin + lane]);
    }
}

double SearchEnergy::of_present(const TetComplex &complex, const Tet &tet) const {
    TetLanes lanes;
    Lanes energy;
    for (int lane = 0; lane < kLanes; ++lane)
        load_tet(complex, tet, lanes, lane);
    evaluate(lanes, flatness_terms(-std::numeric_limits<double>::infinity()), energy, nullptr, true);
    return energy[0] + over(complex, tet);
}

void SearchEnergy::gather(const TetComplex &complex, int v, StarLanes &star) const {
    const std::vector<int> &tets = complex.star(v);
    star.count = static_cast<int>(tets.size());
    const std::size_t groups = (tets.size() + kLanes - 1) / kLanes;
    star.lanes.resize(groups);
    star.terms.assign(groups, flatness_terms(kDegenerate));
    for (std::size_t g = 0; g < groups; ++g) {
        for (int lane = 0; lane < kLanes; ++lane) {
            const std::size_t k = g * kLanes + lane;
            load_star_tet(complex, complex.tet(tets[k < tets.size() ? k : g * kLanes]), v, star.lanes[g], lane);
        }
        // A tet that came in flatter than allowed must not hold its vertices for ever: it may stay as flat as it is.
        WorstLanes worst;
        measure_worst(star.lanes[g], false, worst);
        for (int lane = 0; lane < kLanes; ++lane)
            if (worst.flatness[lane] <= kDegenerate)
                star.terms[g].flatness[lane] = 0.999 * worst.flatness[lane];
    }
}

double SearchEnergy::at(StarLanes &star, const Vec3 &x, Vec3 *gradient) const {
    double sum = 0.0;
    if (gradient)
        *gradient = {};
    for (std::size_t g = 0; g < star.lanes.size(); ++g) {
        star.lanes[g].set_all(0, x);
        Lanes energy;
        Lanes slope[3];
        evaluate(star.lanes[g], star.terms[g], energy, gradient ? slope : nullptr, false);
        const int used = std::min(kLanes, star.count - static_cast<int>(g) * kLanes);
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
        Lanes energy;
        evaluate(star.lanes[g], star.terms[g], energy, nullptr, true);
        const int used = std::min(kLanes, star.count - static_cast<int>(g) * kLanes);
        for (int lane = 0; lane < used; ++lane)
            energies[g * kLanes + lane] = energy[lane];
    }
}

} // namespace wct
