#include "sampling/square_edge_rows.h"

#include "geometry/triangle_edges.h"
#include "sampling/square_corners.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <ranges>
#include <set>
#include <vector>

namespace wct::sampling {

namespace {

constexpr int kQuarters = 4;

// In steps along the crease. Rows on the quarters' sides are half-way between its points and so far off it, rows in the
// quarters' middles beside its points:
constexpr double kSide = std::numbers::sqrt2 / 2.0, kMiddle = 1.0;
// Of an octant at a corner: the point between two creases, in first steps along both, and the one between all three.
// Beyond, the first point of a side's row is so far along its step and off, and the first of a middle's row so far
// along and along both sides. The margins of the facets and circumcenters of all tets round these edges were made
// largest, for the edges alone and with those between three creases; these are between the two.
constexpr double kBetweenTwo = 0.68, kBetweenAll = 0.5;
constexpr double kFirstAlong = 0.57, kFirstOff = 0.6;
constexpr double kMiddleAlong = 0.2, kMiddleOff = 0.6;

/// A step from one point of a crease to the next.
struct Step {
    int curve;
    Vec3 from, to;
    double size; // of edges wanted there
    double length;
    Vec3 along;
};

/// A side of the quarters round a step: its direction, the patch that leaves the crease there (-1: none does), and the
/// region that follows up to the next (-1: what is outside).
struct Side {
    Vec3 away;
    int patch;
    int region;
};

/// In the order of a turn.
using Sides = std::array<Side, kQuarters>;

/// Places the rows of one crease after the other.
class SquareRows {
  public:
    SquareRows(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
               const domain::Sizing &sizing)
        : cloud_(cloud), reference_(reference), map_(map), sizing_(sizing), edges_(reference.data().triangles),
          curves_(reference.patches()) {
        for (int c = 0; c < static_cast<int>(reference.curves().size()); ++c)
            for (const int patch : reference.patches_at_curve(c))
                curves_[patch].push_back(c);
    }

    /// Returns the corners with octants, ascending.
    std::vector<int> seed() {
        const auto chains = curve_chains(cloud_, reference_);
        corners_ = square_corners(cloud_, reference_, chains);
        for (std::size_t i = 0; i < cloud_.count(); ++i)
            grid_.add(cloud_.points[i], kApart * cloud_.size[i]);
        const auto curves = std::views::iota(0, static_cast<int>(chains.size()));
        for (const int c : curves)
            if (meets_interface(c))
                along(c, chains[c]);
        // Rims of one region between corners that have octants now: half a pattern is worse than none.
        const std::set<int> begun = begun_;
        for (const int c : curves)
            if (!chains[c].empty() && !meets_interface(c) && begun.contains(chains[c].front().point) &&
                begun.contains(chains[c].back().point))
                along(c, chains[c]);
        return {begun_.begin(), begun_.end()};
    }

  private:
    static constexpr double kApart = 0.4;  // of the size, from other points
    static constexpr double kDepth = 0.45; // in steps, of points inside from the surface
    static constexpr double kOff = 0.1;    // in steps: farther from its patch a point is none of it
    static constexpr double kRoom = 0.9;   // in steps, of points of patches from other creases
    static constexpr double kBend = 0.3;   // greatest step per radius of the crease

    void along(int curve, const std::vector<CurveStop> &chain) {
        if (chain.size() < 3 || at_layer(curve))
            return;
        const bool closed = reference_.curves()[curve].closed, brief = !closed && chain.size() == 3;
        if (brief && (!corners_.contains(chain.front().point) || !corners_.contains(chain.back().point)))
            return;
        const double bend = greatest_bend(curve);
        std::vector<Step> steps;
        std::vector<Sides> sides;
        for (std::size_t k = 0; k + 1 < chain.size(); ++k) {
            steps.push_back(step_between(curve, chain[k].point, chain[k + 1].point));
            if (bend * steps.back().length > kBend || !find_sides(steps.back(), sides.emplace_back()))
                return;
        }
        for (const CurveStop &stop : chain)
            cloud_.held[stop.point] = std::max(cloud_.held[stop.point], Hold::relaxation);
        const std::size_t last = steps.size() - 1;
        if (closed) {
            for (std::size_t k = 0; k <= last; ++k)
                go_on(steps[k], sides[k], false, false);
            return;
        }
        if (brief)
            put_between(steps[0], sides[0]);
        begin(chain.front().point, steps.front().to, steps.front(), sides.front());
        for (std::size_t k = 1; k < last; ++k)
            go_on(steps[k], sides[k], k == 1, k + 1 == last);
        begin(chain.back().point, steps.back().from, steps.back(), sides.back());
    }

    /// Whether an interface has the crease, or one end of it. Creases that were given up have no vertices.
    bool meets_interface(int curve) const {
        const auto &vertices = reference_.curves()[curve].vertices;
        return !vertices.empty() && (reference_.any_inner(reference_.patches_at_curve(curve)) ||
                                     reference_.any_inner(reference_.patches_at_vertex(vertices.front())) ||
                                     reference_.any_inner(reference_.patches_at_vertex(vertices.back())));
    }

    /// Whether the crease ends at a layer, whose corners have points of their own.
    bool at_layer(int curve) const { return sizing_.layer(reference_.curves()[curve]) > 0.0; }

    Step step_between(int curve, int a, int b) const {
        const Vec3 way = cloud_.points[b] - cloud_.points[a];
        const double size = 0.5 * (cloud_.size[a] + cloud_.size[b]);
        return {curve, cloud_.points[a], cloud_.points[b], size, norm(way), unit(way)};
    }

    /// One by the least radius of a crease; 0 where it is straight.
    double greatest_bend(int curve) const {
        double most = 0.0;
        for (const Vec3 &bend : reference_.curves()[curve].bend)
            most = std::max(most, norm(bend));
        return most;
    }

    /// False where patches leave the crease at angles that are no quarters of a turn, or two of them together.
    bool find_sides(const Step &step, Sides &sides) const {
        constexpr double quarter = 0.5 * std::numbers::pi;
        const domain::Curve &on = reference_.curves()[step.curve];
        const Vec3 middle = 0.5 * (step.from + step.to);
        const int at = reference_.nearest_on_curve(middle, step.curve).step;
        const Edge edge{on.at(at), on.at(at + 1)};
        std::array<int, kQuarters> patch{-1, -1, -1, -1};
        Vec3 zero, one;
        for (const int t : edges_.owners(sorted(edge[0], edge[1]))) {
            const Vec3 away = reference_.away(t, edge, step.along);
            if (norm(zero) == 0.0) {
                zero = away;
                one = cross(step.along, zero);
            }
            const double turn = std::atan2(dot(away, one), dot(away, zero)) / quarter;
            const int q = (static_cast<int>(std::lround(turn)) + kQuarters) % kQuarters;
            if (std::fabs(turn - std::round(turn)) * quarter > kSquare || patch[q] >= 0)
                return false;
            patch[q] = reference_.data().patch[t];
        }
        const std::array<Vec3, kQuarters> ways{zero, one, -1.0 * zero, -1.0 * one};
        for (int q = 0; q < kQuarters; ++q) {
            const Vec3 between = unit(ways[q] + ways[(q + 1) % kQuarters]);
            sides[q] = {ways[q], patch[q], map_.region(middle + (kDepth * step.length) * between, -1)};
        }
        return norm(zero) > 0.0;
    }

    /// The octants at a corner, from the first step along a crease. Sides along which no crease leaves it get a point
    /// where that would have one.
    void begin(int corner, const Vec3 &next, const Step &step, const Sides &sides) {
        const auto found = corners_.find(corner);
        if (found == corners_.end())
            return;
        begun_.insert(corner);
        const Vec3 from = cloud_.points[corner], way = next - from;
        std::array<Vec3, kQuarters> other;
        for (int q = 0; q < kQuarters; ++q)
            other[q] = first_length(found->second, sides[q].away, step.length) * sides[q].away;
        for (int q = 0; q < kQuarters; ++q) {
            if (!is_crease(found->second, sides[q].away))
                put_on_side(from + other[q], step, sides[q]);
            put_on_side(from + kBetweenTwo * (way + other[q]), step, sides[q]);
            put_inside(from + kBetweenAll * (way + other[q] + other[(q + 1) % kQuarters]), step, sides[q].region);
        }
    }

    /// The rows beside a step between others, of which it may be the first, or the last.
    void go_on(const Step &step, const Sides &sides, bool first, bool last) {
        const double off = first || last ? kFirstOff : kSide;
        const double share = first == last ? 0.5 : first ? kFirstAlong : 1.0 - kFirstAlong;
        const Vec3 side = step.from + (share * step.length) * step.along;
        const Vec3 beyond = (kMiddleAlong * step.length) * step.along;
        for (int q = 0; q < kQuarters; ++q) {
            put_on_side(side + (off * step.length) * sides[q].away, step, sides[q]);
            const Vec3 both = step.length * (sides[q].away + sides[(q + 1) % kQuarters].away);
            if (first)
                put_inside(step.from + beyond + kMiddleOff * both, step, sides[q].region);
            else
                put_inside(step.from + (kMiddle / std::numbers::sqrt2) * both, step, sides[q].region);
            if (last)
                put_inside(step.to - beyond + kMiddleOff * both, step, sides[q].region);
        }
    }

    /// What the octants of both corners have between them where a crease has two steps; this is the first.
    void put_between(const Step &step, const Sides &sides) {
        for (int q = 0; q < kQuarters; ++q) {
            const Vec3 both = step.length * (sides[q].away + sides[(q + 1) % kQuarters].away);
            put_inside(step.to + kMiddleOff * both, step, sides[q].region);
        }
    }

    void put_on_side(const Vec3 &p, const Step &step, const Side &side) {
        if (side.patch < 0) {
            put_inside(p, step, side.region);
            return;
        }
        const domain::Foot on = reference_.nearest(p, side.patch);
        if (on.distance < kOff * step.length && has_room(on.point, step, side.patch))
            put(on.point, step, Stratum::patch, side.patch);
    }

    /// Whether the creases of the patch that have no end in common with this one are far enough.
    bool has_room(const Vec3 &p, const Step &step, int patch) const {
        const auto &own = reference_.curves()[step.curve].vertices;
        const auto is_end = [&](int v) { return v == own.front() || v == own.back(); };
        return std::none_of(curves_[patch].begin(), curves_[patch].end(), [&](int c) {
            const auto &other = reference_.curves()[c].vertices;
            return !is_end(other.front()) && !is_end(other.back()) &&
                   reference_.nearest_on_curve(p, c).distance < kRoom * step.length;
        });
    }

    void put_inside(const Vec3 &p, const Step &step, int region) {
        if (region >= 0 && reference_.nearest(p).distance > kDepth * step.length && map_.region(p, -1) == region)
            put(p, step, Stratum::interior, region);
    }

    void put(const Vec3 &p, const Step &step, Stratum role, int label) {
        if (grid_.crowded(p, kApart * step.size))
            return;
        grid_.add(p, kApart * step.size);
        cloud_.add(p, role, label, step.size);
        cloud_.held.back() = Hold::relaxation;
    }

    Cloud &cloud_;
    const domain::Reference &reference_;
    const domain::RegionMap &map_;
    const domain::Sizing &sizing_;
    const geometry::TriangleEdges edges_;
    std::vector<std::vector<int>> curves_; // of each patch
    std::map<int, std::vector<FirstStep>> corners_;
    std::set<int> begun_; // corners with octants
    PointGrid grid_;
};

} // namespace

std::vector<int> seed_square_rows(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
                                  const domain::Sizing &sizing) {
    return reference.has_inner() ? SquareRows(cloud, reference, map, sizing).seed() : std::vector<int>{};
}

} // namespace wct::sampling
