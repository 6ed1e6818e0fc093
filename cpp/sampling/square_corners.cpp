#include "sampling/square_corners.h"

#include "sampling/corner_spokes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wct::sampling {

namespace {

constexpr double kUneven = 1.1; // longest first step per shortest

bool all_square(const std::vector<FirstStep> &steps) {
    for (std::size_t i = 0; i < steps.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const double cosine = std::fabs(dot(steps[i].way, steps[j].way));
            if (cosine > std::sin(kSquare) && cosine < std::cos(kSquare))
                return false;
        }
    return true;
}

/// Whether creases square to each other are no longer than two steps: the octants at the corners of a side between them
/// leave no room for the point that its middle wants.
bool is_cramped(const std::vector<Spoke> &spokes, const std::vector<FirstStep> &steps) {
    for (std::size_t i = 0; i < spokes.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (!spokes[i].alone() && !spokes[j].alone() &&
                std::fabs(dot(steps[i].way, steps[j].way)) < std::sin(kSquare))
                return true;
    return false;
}

} // namespace

std::map<int, std::vector<FirstStep>> square_corners(Cloud &cloud, const domain::Reference &reference,
                                                     const std::vector<std::vector<CurveStop>> &chains) {
    const auto corners = spokes_of(chains, reference);
    std::map<int, std::vector<FirstStep>> square;
    for (const auto &[corner, spokes] : corners) {
        std::vector<FirstStep> steps;
        for (const Spoke &spoke : spokes) {
            const Vec3 way = cloud.points[spoke.point] - cloud.points[corner];
            steps.push_back({unit(way), norm(way)});
        }
        if (all_square(steps) && !is_cramped(spokes, steps))
            square.emplace(corner, std::move(steps));
    }
    for (auto &[corner, steps] : square) {
        const auto shorter = [](const FirstStep &a, const FirstStep &b) { return a.length < b.length; };
        const double most = kUneven * std::min_element(steps.begin(), steps.end(), shorter)->length;
        const std::vector<Spoke> &spokes = corners.at(corner);
        for (std::size_t k = 0; k < steps.size(); ++k)
            if (steps[k].length > most && spokes[k].alone() && cloud.held[spokes[k].point] == Hold::none) {
                steps[k].length = most;
                put_at(cloud, reference, corner, spokes[k], most);
            }
    }
    return square;
}

bool is_crease(const std::vector<FirstStep> &steps, const Vec3 &way) {
    return std::any_of(steps.begin(), steps.end(),
                       [&](const FirstStep &step) { return dot(step.way, way) > std::cos(kSquare); });
}

double first_length(const std::vector<FirstStep> &steps, const Vec3 &way, double other) {
    for (const double sign : {1.0, -1.0})
        for (const FirstStep &step : steps)
            if (sign * dot(step.way, way) > std::cos(kSquare))
                return step.length;
    return other;
}

} // namespace wct::sampling
