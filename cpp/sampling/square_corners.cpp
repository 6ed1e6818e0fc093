#include "sampling/square_corners.h"

#include <algorithm>
#include <cmath>

namespace wct::sampling {

namespace {

constexpr double kUneven = 1.1; // longest first step per shortest

bool all_square(const std::vector<Spoke> &spokes) {
    for (std::size_t i = 0; i < spokes.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const double cosine = std::fabs(dot(spokes[i].way, spokes[j].way));
            if (cosine > std::sin(kSquare) && cosine < std::cos(kSquare))
                return false;
        }
    return true;
}

/// Whether creases square to each other are no longer than two steps: the octants at the corners of a side between them
/// leave no room for the point that its middle wants.
bool is_cramped(const std::vector<Spoke> &spokes) {
    for (const Spoke &one : spokes)
        for (const Spoke &other : spokes)
            if (one.steps <= 2 && other.steps <= 2 && std::fabs(dot(one.way, other.way)) < std::sin(kSquare))
                return true;
    return false;
}

} // namespace

std::map<int, std::vector<Spoke>> square_corners(Cloud &cloud, const domain::Reference &reference,
                                                 const std::vector<std::vector<CurveStop>> &chains) {
    std::map<int, std::vector<Spoke>> corners;
    for (int c = 0; c < static_cast<int>(chains.size()); ++c) {
        const auto &chain = chains[c];
        if (reference.curves()[c].closed || chain.size() < 2)
            continue;
        const int steps = static_cast<int>(chain.size()) - 1;
        const auto add = [&](int corner, int next) {
            const Vec3 way = cloud.points[next] - cloud.points[corner];
            corners[corner].push_back(
                {c, next, steps, steps > 2 && cloud.held[next] == Hold::none, unit(way), norm(way)});
        };
        add(chain.front().point, chain[1].point);
        add(chain.back().point, chain[chain.size() - 2].point);
    }
    std::erase_if(corners, [](const auto &corner) { return !all_square(corner.second) || is_cramped(corner.second); });
    for (auto &[corner, spokes] : corners) {
        const auto shorter = [](const Spoke &a, const Spoke &b) { return a.length < b.length; };
        const double most = kUneven * std::min_element(spokes.begin(), spokes.end(), shorter)->length;
        for (Spoke &spoke : spokes)
            if (spoke.moves && spoke.length > most) {
                spoke.length = most;
                cloud.points[spoke.next] =
                    reference.nearest_on_curve(cloud.points[corner] + most * spoke.way, spoke.curve, true).point;
            }
    }
    return corners;
}

bool is_crease(const std::vector<Spoke> &spokes, const Vec3 &way) {
    return std::any_of(spokes.begin(), spokes.end(),
                       [&](const Spoke &spoke) { return dot(spoke.way, way) > std::cos(kSquare); });
}

double first_step(const std::vector<Spoke> &spokes, const Vec3 &way, double other) {
    for (const double sign : {1.0, -1.0})
        for (const Spoke &spoke : spokes)
            if (sign * dot(spoke.way, way) > std::cos(kSquare))
                return spoke.length;
    return other;
}

} // namespace wct::sampling
