#include "sampling/square_edge_rows.h"

#include "sampling/curve_chains.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wct::sampling {

namespace {

// Angles that one row divides into two that tets fill.
constexpr double kLeast = 75.0 * std::numbers::pi / 180.0;
constexpr double kMost = 165.0 * std::numbers::pi / 180.0;
// In steps along the crease.
constexpr double kFar = 0.96;  // of the row from it
constexpr double kDeep = 0.35; // least depth of the row
// In sizes.
constexpr double kApart = 0.62;                   // from other points
constexpr double kShortest = 0.6, kLongest = 1.5; // steps beside which the pattern would not go on

/// Across a curve into a patch, from a point of both, perpendicular to the tangent; zero where the patch does not tell.
Vec3 into_patch(const domain::Reference &reference, const Vec3 &at, const Vec3 &tangent, int patch, double step) {
    constexpr double ahead = 0.4, clear = 0.1;
    const Vec3 way = unit(cross(reference.smooth_normal(reference.nearest(at, patch)), tangent));
    const double on = reference.nearest(at + (ahead * step) * way, patch).distance;
    const double off = reference.nearest(at - (ahead * step) * way, patch).distance;
    if (std::fabs(on - off) < clear * step)
        return {};
    return on < off ? way : -1.0 * way;
}

/// Whether a patch is on the boundary: no interface, no sheet.
bool outer(const domain::Reference &reference, int patch) {
    const auto &[behind, before] = reference.data().sides[patch];
    return (behind < 0) != (before < 0);
}

} // namespace

void seed_square_rows(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
                      const domain::Sizing &sizing, const std::optional<PartialRenewal> &renewal) {
    PointGrid grid;
    for (std::size_t i = 0; i < cloud.count(); ++i)
        grid.add(cloud.points[i], kApart * cloud.size[i]);
    std::vector<char> parted(
        1,
        0); // regions with interfaces or sheets: they come right oftener with more points, as without rows
    for (const auto &sides : reference.data().sides)
        for (const int region : sides)
            if (region >= 0) {
                parted.resize(std::max<std::size_t>(parted.size(), region + 1), 0);
                parted[region] |= sides[0] >= 0 && sides[1] >= 0;
            }
    const auto chains = curve_chains(cloud, reference);
    for (int c = 0; c < static_cast<int>(chains.size()); ++c) {
        const std::vector<int> &patches = reference.patches_at_curve(c);
        if (patches.size() != 2 || !outer(reference, patches[0]) || !outer(reference, patches[1]) ||
            sizing.sharp().of_curve(c) || sizing.notches().of_curve(c))
            continue;
        const auto &chain = chains[c];
        for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
            const int point = chain[k].point;
            if (cloud.role[point] != Stratum::crease) // a corner has tets of its own
                continue;
            const Vec3 at = cloud.points[point];
            const double size = cloud.size[point], step = norm(cloud.points[chain[k + 1].point] - at);
            if (step < kShortest * size || step > kLongest * size)
                continue;
            const Vec3 tangent = reference.nearest_on_curve(at, c).tangent;
            const Vec3 first = into_patch(reference, at, tangent, patches[0], step);
            const Vec3 second = into_patch(reference, at, tangent, patches[1], step);
            const double wide = angle(first, second);
            if (first == Vec3{} || second == Vec3{} || wide < kLeast || wide > kMost)
                continue;
            const Vec3 p = at + (kFar * step) * unit(first + second);
            if ((renewal && !renewal->reaches(p, 0.0)) || grid.crowded(p, kApart * size))
                continue;
            const domain::Foot foot = reference.nearest(p);
            const int region = map.region(p, foot);
            if (region < 0 || parted[region] || foot.distance < kDeep * step)
                continue;
            grid.add(p, kApart * size);
            cloud.add(p, Stratum::interior, region, size);
        }
    }
}

} // namespace wct::sampling
