#include "sampling/seed_corners.h"

#include "sampling/corner_spokes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace wct::sampling {

namespace {

constexpr double kOff = 0.2;      // of a point from its patch, in distances from the corner: the patch ends before
constexpr double kWidest = 1.309; // angle of a patch at a corner that one facet may fill: 75 degrees
constexpr double kSharp = 0.5;    // cosine of the angle between creases below which it is sharp: 60 degrees
constexpr double kSquare = 0.1;   // cosine of the angle between creases that count as square
// The corner of a cube in 34 tets (create_cube_corner): seven points are joined to the corner. Three are on the
// creases, equally far from it; in that distance, the three between two creases and the one between all are at
constexpr double kFace = 0.833;
constexpr double kInner = 0.721;

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
        if (!any || !one.alone())
            continue;
        sharp.push_back(&one);
        sum += norm(cloud.points[one.point] - at);
    }
    for (const Spoke *one : sharp)
        put_at(cloud, reference, corner, *one, sum / static_cast<double>(sharp.size()));
}

/// Three creases at a corner that are square to each other, and what is between them.
struct Octant {
    std::array<Spoke, 3> spokes;
    int region;

    bool has(int point) const {
        return std::any_of(spokes.begin(), spokes.end(), [&](const Spoke &spoke) { return spoke.point == point; });
    }
};

/// The octants of a corner, those of regions alone, with a point on each of their creases.
std::vector<Octant> octants_at(const Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
                               int corner, const std::vector<Spoke> &around) {
    const Vec3 at = cloud.points[corner];
    const auto way = [&](const Spoke &a) { return unit(cloud.points[a.point] - at); };
    const auto square = [&](const Spoke &a, const Spoke &b) {
        return std::fabs(dot(way(a), way(b))) < kSquare && reference.share_patch(a.curve, b.curve);
    };
    std::vector<Octant> out;
    for (std::size_t i = 0; i < around.size(); ++i)
        for (std::size_t j = i + 1; j < around.size(); ++j)
            for (std::size_t k = j + 1; k < around.size(); ++k) {
                const Spoke &a = around[i], &b = around[j], &c = around[k];
                if (!square(a, b) || !square(a, c) || !square(b, c))
                    continue;
                const auto is_corner = [&](const Spoke *one) { return cloud.role[one->point] == Stratum::corner; };
                if (is_corner(&a) || is_corner(&b) || is_corner(&c))
                    continue;
                double near = norm(cloud.points[a.point] - at);
                for (const Spoke *one : {&b, &c})
                    near = std::min(near, norm(cloud.points[one->point] - at));
                const int region = map.region(at + (0.5 * near) * unit(way(a) + way(b) + way(c)), -1);
                if (region >= 0)
                    out.push_back({{a, b, c}, region});
            }
    return out;
}

/// The next points on the creases of octants at a corner come as far from it as the nearest is.
void even_square(Cloud &cloud, const domain::Reference &reference, int corner, const std::vector<Octant> &octants) {
    const Vec3 at = cloud.points[corner];
    double near = std::numeric_limits<double>::infinity();
    for (const Octant &octant : octants)
        for (const Spoke &spoke : octant.spokes)
            near = std::min(near, norm(cloud.points[spoke.point] - at));
    for (const Octant &octant : octants)
        for (const Spoke &spoke : octant.spokes)
            if (spoke.alone())
                put_at(cloud, reference, corner, spoke, near);
}

/// The angles that patches have at the corners of the surface, by corner and patch.
std::map<std::pair<int, int>, Opening> openings_of(const domain::Reference &reference) {
    const auto &data = reference.data();
    const std::set<int> corners(data.corners.begin(), data.corners.end());
    std::map<std::pair<int, int>, Opening> openings;
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
    return openings;
}

/// Divide a wide angle that a patch has at a corner between the points `ends` of its two creases there.
void divide(Cloud &cloud, const domain::Reference &reference, int corner, int patch, const std::array<int, 2> &ends,
            const Opening &opening, bool square) {
    const Vec3 at = cloud.points[corner], n = unit(opening.normal);
    const Vec3 first = cloud.points[ends[0]] - at, last = cloud.points[ends[1]] - at;
    const double way = dot(turned(first, n, opening.angle), last) > dot(turned(first, n, -opening.angle), last)
                           ? opening.angle
                           : -opening.angle;
    const double radius = (square ? kFace : 1.0) * 0.5 * (norm(first) + norm(last));
    const int parts = static_cast<int>(std::ceil(opening.angle / kWidest));
    for (int k = 1; k < parts; ++k) {
        const Vec3 p = at + radius * unit(turned(first, n, way * k / parts));
        const domain::Foot foot = reference.nearest(p, patch);
        if (foot.distance < kOff * radius)
            cloud.add(foot.point, Stratum::patch, patch, cloud.size[corner]);
    }
}

} // namespace

void seed_corners(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
                  const domain::Sizing &sizing, std::span<const int> divided) {
    const auto openings = openings_of(reference);
    const auto spokes = spokes_of(curve_chains(cloud, reference), reference);
    for (const auto &[corner, around] : spokes)
        even_sharp(cloud, reference, corner, around);
    for (const auto &[corner, around] : spokes) {
        if (cloud.role[corner] != Stratum::corner || std::binary_search(divided.begin(), divided.end(), corner))
            continue;
        // At the ends of longer creases there is room for points to find their places.
        const std::vector<Octant> octants = sizing.layer(cloud.label[corner]) > 0.0
                                                ? octants_at(cloud, reference, map, corner, around)
                                                : std::vector<Octant>{};
        even_square(cloud, reference, corner, octants);
        for (const int patch : reference.patches_at_vertex(cloud.label[corner])) {
            std::vector<int> ends;
            for (const Spoke &spoke : around) {
                const auto &own = reference.patches_at_curve(spoke.curve);
                if (std::binary_search(own.begin(), own.end(), patch))
                    ends.push_back(spoke.point);
            }
            if (ends.size() != 2) // more creases, and which of them are neighbours is another question
                continue;
            const bool square = std::any_of(octants.begin(), octants.end(), [&](const Octant &octant) {
                return octant.has(ends[0]) && octant.has(ends[1]);
            });
            divide(cloud, reference, corner, patch, {ends[0], ends[1]}, openings.at({cloud.label[corner], patch}),
                   square);
        }
        const Vec3 at = cloud.points[corner];
        for (const auto &[creases, region] : octants) {
            Vec3 sum;
            for (const Spoke &spoke : creases)
                sum += cloud.points[spoke.point] - at;
            cloud.add(at + (kInner / std::sqrt(3.0)) * sum, Stratum::interior, region, cloud.size[corner]);
        }
    }
}

} // namespace wct::sampling
