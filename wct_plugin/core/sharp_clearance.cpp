#include "sharp_clearance.h"

#include "curve_chains.h"

#include <array>

namespace wct {

namespace {

bool may_go(const Cloud &cloud, std::size_t i) {
    return cloud.held[i] == Hold::none && (cloud.role[i] == Stratum::patch || cloud.role[i] == Stratum::interior);
}

/// How two rows of points stand beside a sharp edge: shares of a step along the crease, of the first, of one between,
/// and of the last, where the rows begin and end with a point of the curves that leave the corner.
struct RowForm {
    double widest; // edges that are less narrow do as well without: see SharpEdges::narrow
    std::array<double, 2> first, between, last;
};
constexpr RowForm kInside{0.85, {0.55, 0.7}, {0.4, 0.6}, {0.3, 0.45}}; // 50 degrees
/// Over an angle outside, facets of one side stay free of the other's points where those mirror its own.
constexpr RowForm kOutside{0.85, {0.62, 0.62}, {0.5, 0.5}, {0.38, 0.38}};
constexpr double kHeight = 0.87; // of a regular facet, in its edges

/// Along a triangle, away from its edge.
Vec3 away(const Reference &reference, int triangle, const std::array<int, 2> &edge) {
    const auto &points = reference.data().points;
    const Vec3 along = unit(points[edge[1]] - points[edge[0]]);
    for (const int v : reference.data().triangles[triangle])
        if (v != edge[0] && v != edge[1]) {
            const Vec3 d = points[v] - points[edge[0]];
            return unit(d - dot(d, along) * along);
        }
    return {};
}

/// `clearance(foot, step)`: how far from the edge the rows are, where steps along it are so long.
template <class Clearance>
void seed_rows(Cloud &cloud, const Reference &reference, const SharpEdges &sharp, const RowForm &form,
               const Clearance &clearance) {
    constexpr double off = 0.3;   // farther from its patch than this share of the clearance, a point is none of it
    constexpr double apart = 0.4; // of the size, from other points
    if (sharp.empty())
        return;
    PointGrid grid;
    for (std::size_t i = 0; i < cloud.count(); ++i)
        grid.add(cloud.points[i], apart * cloud.size[i]);
    const auto stand = [&](const Vec3 &at, const Vec3 &along, double size, int row) {
        const SharpFoot foot = sharp.nearest(at, size);
        if (foot.edge < 0 || sharp.narrow(foot.edge) > form.widest)
            return;
        // The first row is on the side whose triangles run along the crease as its points do.
        const auto &beside = sharp.beside(foot.edge);
        const Vec3 first = away(reference, beside[0], sharp.ends(foot.edge));
        const bool forward = dot(cross(along, first), reference.normal(beside[0])) > 0.0;
        const int triangle = beside[forward ? row : 1 - row], patch = reference.data().patch[triangle];
        const double far = clearance(foot, norm(along));
        Vec3 p = at + far * away(reference, triangle, sharp.ends(foot.edge));
        const Foot on = reference.nearest(p, patch);
        if (on.distance > off * far || grid.crowded(on.point, apart * size))
            return;
        reference.to_patch(p, on);
        grid.add(p, apart * size);
        cloud.add(p, Stratum::patch, patch, size);
        cloud.held.back() = Hold::relaxation;
    };
    const auto chains = curve_chains(cloud, reference);
    for (int c = 0; c < static_cast<int>(chains.size()); ++c) {
        if (!sharp.of_curve(c))
            continue;
        const bool closed = reference.curves()[c].closed;
        for (const CurveStop &stop : chains[c])
            cloud.held[stop.point] = Hold::relaxation;
        for (std::size_t k = 0; k + 1 < chains[c].size(); ++k) {
            const int a = chains[c][k].point, b = chains[c][k + 1].point;
            const Vec3 from = cloud.points[a], to = cloud.points[b];
            const double size = 0.5 * (cloud.size[a] + cloud.size[b]);
            const auto &shares = !closed && k == 0                      ? form.first
                                 : !closed && k + 2 == chains[c].size() ? form.last
                                                                        : form.between;
            for (int row = 0; row < 2; ++row)
                stand((1.0 - shares[row]) * from + shares[row] * to, to - from, size, row);
        }
    }
}

} // namespace

void seed_sharp_rows(Cloud &cloud, const Reference &reference, const Sizing &sizing) {
    seed_rows(cloud, reference, sizing.sharp(), kInside,
              [&](const SharpFoot &foot, double) { return sizing.clearance(foot); });
    seed_rows(cloud, reference, sizing.notches(), kOutside,
              [](const SharpFoot &, double step) { return kHeight * step; });
}

void clear_sharp(Cloud &cloud, const Sizing &sizing) {
    constexpr double well = 0.8;
    if (sizing.sharp().empty())
        return;
    std::vector<char> keep(cloud.count(), 1);
    for (std::size_t i = 0; i < cloud.count(); ++i)
        if (may_go(cloud, i))
            if (const SharpFoot foot = sizing.cleared_by(cloud.points[i]); foot.edge >= 0)
                keep[i] = foot.distance >= well * sizing.clearance(foot);
    cloud.keep(keep);
}

void keep_off_sharp(Cloud &cloud, const Reference &reference, const Sizing &sizing, const Workers &workers) {
    if (sizing.sharp().empty())
        return;
    workers.for_each(cloud.count(), 256, [&](std::size_t i) {
        if (!may_go(cloud, i))
            return;
        const SharpFoot foot = sizing.cleared_by(cloud.points[i]);
        if (foot.edge < 0 || foot.distance == 0.0)
            return;
        cloud.points[i] = foot.point + (sizing.clearance(foot) / foot.distance) * (cloud.points[i] - foot.point);
        if (cloud.role[i] == Stratum::patch) {
            const Foot on = reference.nearest(cloud.points[i], cloud.label[i], cloud.near[i]);
            cloud.near[i] = on.triangle;
            reference.to_patch(cloud.points[i], on);
        }
    });
}

} // namespace wct
