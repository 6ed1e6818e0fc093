#include "sampling/sharp_edge_rows.h"

#include "sampling/curve_chains.h"

#include <algorithm>
#include <array>
#include <optional>

namespace wct::sampling {

namespace {

bool may_go(const Cloud &cloud, std::size_t i) {
    return cloud.held[i] == Hold::none && (cloud.role[i] == Stratum::patch || cloud.role[i] == Stratum::interior);
}

/// Shares of a step along the crease at which the points of the two rows stand: of the first, of one between, and of
/// the last, where the rows begin and end with a point of the curves that leave the corner.
constexpr std::array<double, 2> kFirst{0.55, 0.7}, kBetween{0.4, 0.6}, kLast{0.3, 0.45};
/// The same of the first row over an angle outside.
constexpr double kMirroredFirst = 0.62, kMirroredBetween = 0.5, kMirroredLast = 0.38;

/// Along a triangle, away from its edge.
Vec3 away(const domain::Reference &reference, int triangle, const Edge &edge) {
    const auto &points = reference.data().points;
    return reference.away(triangle, edge, unit(points[edge[1]] - points[edge[0]]));
}

/// A step of a chain along a sharp crease, and whether a corner is at either end.
struct Step {
    Vec3 from, to;
    double size;
    bool first, last;
};

/// Finds places beside sharp edges, and puts points there that stay where they are.
class RowPlacer {
  public:
    struct Place {
        Vec3 point;
        int patch;
        double size;
    };

    RowPlacer(Cloud &cloud, const domain::Reference &reference, const domain::SharpEdges &sharp)
        : cloud_(cloud), reference_(reference), sharp_(sharp) {
        for (std::size_t i = 0; i < cloud.count(); ++i)
            grid_.add(cloud.points[i], kApart * cloud.size[i]);
    }

    /// Where the point this far from one of the edge is, on the first (0) or second (1) side, if there is room: the
    /// first is the one whose triangles run along the crease as its points do.
    std::optional<Place> beside(const Vec3 &at, int edge, const Step &step, int side, double far) const {
        constexpr double off = 0.3; // farther from its patch than this share of the way, a point is none of it
        const auto &triangles = sharp_.beside(edge);
        const Vec3 first = away(reference_, triangles[0], sharp_.ends(edge));
        const bool forward = dot(cross(step.to - step.from, first), reference_.normal(triangles[0])) > 0.0;
        const int triangle = triangles[forward ? side : 1 - side], patch = reference_.data().patch[triangle];
        Vec3 p = at + far * away(reference_, triangle, sharp_.ends(edge));
        const domain::Foot on = reference_.nearest(p, patch);
        if (on.distance > off * far || grid_.crowded(on.point, kApart * step.size))
            return std::nullopt;
        reference_.to_patch(p, on);
        return Place{p, patch, step.size};
    }

    void add(const Place &place) {
        grid_.add(place.point, kApart * place.size);
        cloud_.add(place.point, Stratum::patch, place.patch, place.size);
        cloud_.held.back() = Hold::descent;
    }

  private:
    static constexpr double kApart = 0.4; // of the size, from other points

    Cloud &cloud_;
    const domain::Reference &reference_;
    const domain::SharpEdges &sharp_;
    PointGrid grid_;
};

template <class Visit>
void each_step(Cloud &cloud, const domain::Reference &reference, const domain::SharpEdges &sharp, const Visit &visit) {
    const auto chains = curve_chains(cloud, reference);
    for (int c = 0; c < static_cast<int>(chains.size()); ++c) {
        if (!sharp.of_curve(c))
            continue;
        const bool closed = reference.curves()[c].closed;
        for (const CurveStop &stop : chains[c])
            cloud.held[stop.point] = std::max(cloud.held[stop.point], Hold::descent);
        for (std::size_t k = 0; k + 1 < chains[c].size(); ++k) {
            const int a = chains[c][k].point, b = chains[c][k + 1].point;
            visit(Step{cloud.points[a], cloud.points[b], 0.5 * (cloud.size[a] + cloud.size[b]), !closed && k == 0,
                       !closed && k + 2 == chains[c].size()});
        }
    }
}

Vec3 within(const Step &step, double share) {
    return (1.0 - share) * step.from + share * step.to;
}

void seed_over_inside(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing) {
    constexpr double widest = 0.85; // blunter edges do as well without: 50 degrees
    const domain::SharpEdges &sharp = sizing.sharp();
    if (sharp.empty())
        return;
    RowPlacer rows(cloud, reference, sharp);
    each_step(cloud, reference, sharp, [&](const Step &step) {
        const auto &shares = step.first ? kFirst : step.last ? kLast : kBetween;
        for (int side = 0; side < 2; ++side) {
            const Vec3 at = within(step, shares[side]);
            const domain::SharpFoot foot = sharp.nearest(at, step.size);
            if (foot.edge < 0 || sharp.narrow(foot.edge) > widest)
                continue;
            if (const auto place = rows.beside(at, foot.edge, step, side, sizing.clearance(foot)))
                rows.add(*place);
        }
    });
}

void seed_over_outside(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing) {
    constexpr double height = 0.87; // of a row, in steps
    constexpr double apart = 0.9;   // how far the sides are from where no row is needed any more, in steps
    const domain::SharpEdges &sharp = sizing.notches();
    if (sharp.empty())
        return;
    RowPlacer rows(cloud, reference, sharp);
    each_step(cloud, reference, sharp, [&](const Step &step) {
        const double length = norm(step.to - step.from);
        for (int row = 1;; ++row) {
            if (row % 2 == 0 && step.last)
                continue; // the crease that leaves the corner has a point there
            const double share = row % 2 == 0 ? 1.0
                                 : step.first ? kMirroredFirst
                                 : step.last  ? kMirroredLast
                                              : kMirroredBetween;
            const domain::SharpFoot foot = sharp.nearest(within(step, share), step.size);
            if (foot.edge < 0 || sharp.narrow(foot.edge) < domain::Sizing::kNarrowestNotch ||
                row * height * sharp.narrow(foot.edge) > apart)
                break;
            const auto put = [&](int side) {
                return rows.beside(foot.point, foot.edge, step, side, row * height * length);
            };
            const auto one = put(0), other = put(1); // both before either: they may be close to each other
            if (!one || !other)
                continue;
            rows.add(*one);
            rows.add(*other);
        }
    });
}

} // namespace

void seed_sharp_rows(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing) {
    seed_over_inside(cloud, reference, sizing);
    seed_over_outside(cloud, reference, sizing);
}

void clear_sharp(Cloud &cloud, const domain::Sizing &sizing) {
    constexpr double well = 0.8;
    if (sizing.sharp().empty())
        return;
    std::vector<char> keep(cloud.count(), 1);
    for (std::size_t i = 0; i < cloud.count(); ++i)
        if (may_go(cloud, i))
            if (const domain::SharpFoot foot = sizing.cleared_by(cloud.points[i]); foot.edge >= 0)
                keep[i] = foot.distance >= well * sizing.clearance(foot);
    cloud.keep(keep);
}

void keep_off_sharp(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing,
                    const Workers &workers) {
    if (sizing.sharp().empty())
        return;
    workers.for_each(cloud.count(), 256, [&](std::size_t i) {
        if (!may_go(cloud, i))
            return;
        const domain::SharpFoot foot = sizing.cleared_by(cloud.points[i]);
        if (foot.edge < 0 || foot.distance == 0.0)
            return;
        cloud.points[i] = foot.point + (sizing.clearance(foot) / foot.distance) * (cloud.points[i] - foot.point);
        if (cloud.role[i] == Stratum::patch) {
            const domain::Foot on = reference.nearest(cloud.points[i], cloud.label[i], cloud.near[i]);
            cloud.near[i] = on.triangle;
            reference.to_patch(cloud.points[i], on);
        }
    });
}

} // namespace wct::sampling
