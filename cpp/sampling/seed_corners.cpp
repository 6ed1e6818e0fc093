#include "sampling/seed_corners.h"

#include "sampling/curve_chains.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace wct::sampling {

namespace {

constexpr double kWidest = 1.309; // angle of a patch at a corner that one facet may fill: 75 degrees
constexpr double kSharp = 0.5;    // cosine of the angle between creases below which it is sharp: 60 degrees

/// Where a crease leaves a corner.
struct Spoke {
    int curve;
    int point;  // next on the curve
    bool alone; // no corner, nor the point next to one at the curve's other end
};

/// v turned by an angle about the unit vector n.
Vec3 turned(const Vec3 &v, const Vec3 &n, double angle) {
    return std::cos(angle) * v + std::sin(angle) * cross(n, v) + ((1.0 - std::cos(angle)) * dot(n, v)) * n;
}

/// The angle that a patch has at a vertex of the reference, and its normal there.
struct Opening {
    double angle = 0.0;
    Vec3 normal;
};

/// Where creases meet at a sharp angle, a facet from one to the other is acute only if they are about equally long:
/// their next points go as far from the corner as they are in the mean.
void even_sharp(Cloud &cloud, const domain::Reference &reference, int corner, const std::vector<Spoke> &around) {
    const Vec3 at = cloud.points[corner];
    std::vector<const Spoke *> sharp;
    double sum = 0.0;
    for (const Spoke &one : around) {
        const Vec3 way = unit(cloud.points[one.point] - at);
        const bool any = std::any_of(around.begin(), around.end(), [&](const Spoke &other) {
            return &other != &one && dot(way, unit(cloud.points[other.point] - at)) > kSharp;
        });
        if (!any || !one.alone)
            continue;
        sharp.push_back(&one);
        sum += norm(cloud.points[one.point] - at);
    }
    for (const Spoke *one : sharp) {
        if (cloud.held[one->point] == Hold::given)
            continue;
        Vec3 &p = cloud.points[one->point];
        p = reference.nearest_on_curve(at + (sum / static_cast<double>(sharp.size())) * unit(p - at), one->curve, true)
                .point;
    }
}

} // namespace

void seed_corners(Cloud &cloud, const domain::Reference &reference) {
    const auto &data = reference.data();
    const std::set<int> corners(data.corners.begin(), data.corners.end());
    std::map<std::pair<int, int>, Opening> openings; // corner, patch
    for (std::size_t t = 0; t < data.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const int v = data.triangles[t][k];
            if (!corners.contains(v))
                continue;
            const Vec3 p = data.points[data.triangles[t][(k + 1) % 3]] - data.points[v];
            const Vec3 q = data.points[data.triangles[t][(k + 2) % 3]] - data.points[v];
            const double wide = angle(p, q);
            Opening &opening = openings[{v, data.patch[t]}];
            opening.angle += wide;
            opening.normal += wide * reference.normal(static_cast<int>(t));
        }
    std::map<int, std::vector<Spoke>> spokes; // corner point -> its creases
    const auto chains = curve_chains(cloud, reference);
    for (int c = 0; c < static_cast<int>(chains.size()); ++c) {
        const auto &chain = chains[c];
        if (chain.size() < 2 || reference.curves()[c].closed)
            continue;
        const bool alone = chain.size() > 3;
        spokes[chain.front().point].push_back({c, chain[1].point, alone});
        spokes[chain.back().point].push_back({c, chain[chain.size() - 2].point, alone});
    }
    for (const auto &[corner, around] : spokes)
        even_sharp(cloud, reference, corner, around);
    for (const auto &[corner, around] : spokes) {
        if (cloud.role[corner] != Stratum::corner)
            continue;
        const Vec3 at = cloud.points[corner];
        for (const int patch : reference.patches_at_vertex(cloud.label[corner])) {
            std::vector<int> ends;
            for (const Spoke &spoke : around) {
                const auto &own = reference.patches_at_curve(spoke.curve);
                if (std::binary_search(own.begin(), own.end(), patch))
                    ends.push_back(spoke.point);
            }
            if (ends.size() != 2) // more creases, and which of them are neighbours is another question
                continue;
            const Opening &opening = openings[{cloud.label[corner], patch}];
            const Vec3 n = unit(opening.normal);
            const Vec3 first = cloud.points[ends[0]] - at, last = cloud.points[ends[1]] - at;
            const double way = dot(turned(first, n, opening.angle), last) > dot(turned(first, n, -opening.angle), last)
                                   ? opening.angle
                                   : -opening.angle;
            const double radius = 0.5 * (norm(first) + norm(last));
            const int parts = static_cast<int>(std::ceil(opening.angle / kWidest));
            for (int k = 1; k < parts; ++k) {
                Vec3 p = at + radius * unit(turned(first, n, way * k / parts));
                const domain::Foot foot = reference.nearest(p, patch);
                if (foot.distance < 0.2 * radius)
                    cloud.add(foot.point, Stratum::patch, patch, cloud.size[corner]);
            }
        }
    }
}

} // namespace wct::sampling
