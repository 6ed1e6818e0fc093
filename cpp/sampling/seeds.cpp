#include "sampling/seeds.h"

#include "sampling/lattice_levels.h"
#include "sampling/seed_corners.h"
#include "sampling/seed_walls.h"
#include "sampling/sharp_edge_rows.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wct::sampling {

namespace {

/// In [-1, 1)^3.
Vec3 in_cube(Random &random) {
    const double x = 2.0 * random.uniform() - 1.0;
    const double y = 2.0 * random.uniform() - 1.0;
    return {x, y, 2.0 * random.uniform() - 1.0};
}

/// Whether points are wanted in a ball: everywhere, or where a renewal makes them anew.
bool wanted(const std::optional<PartialRenewal> &renewal, const Vec3 &center, double radius = 0.0) {
    return !renewal || renewal->reaches(center, radius);
}

/// Whether an edge across the curve's vertex k would leave the tolerance. Along other curves facets of curved patches,
/// which stand out to both sides, see to it that nothing is lost; the corners of a wire or a flat rim must stay.
bool keeps_corner(const domain::Reference &reference, const domain::Sizing &sizing, int c, int k) {
    const domain::Curve &curve = reference.curves()[c];
    if (!reference.bare(c) || (k == 0 && !curve.closed))
        return false;
    const auto &points = reference.data().points;
    const Vec3 &p = points[curve.vertices[k]];
    const double turn = angle(p - points[curve.at(k == 0 ? curve.steps() - 1 : k - 1)], points[curve.at(k + 1)] - p);
    return 0.5 * sizing.at(p) * std::sin(0.5 * turn) > sizing.form().tolerance_at(curve.vertices[k]);
}

/// Arc length along a curve in units of the local edge length, on a polyline fine enough for the size field.
struct CurveSteps {
    struct Step {
        Vec3 from, to;
        double before, length;
    };
    std::vector<Step> steps;
    double total = 0.0;
    std::vector<double> kept; // where the curve's own corners are

    /// The point so far along the curve.
    Vec3 at(double wanted) const {
        const auto after = std::partition_point(steps.begin(), steps.end() - 1,
                                                [&](const Step &s) { return s.before + s.length < wanted; });
        const double t = after->length > 0.0 ? (wanted - after->before) / after->length : 0.0;
        return after->from + t * (after->to - after->from);
    }
};

CurveSteps measure_curve(const domain::Reference &reference, const domain::Sizing &sizing, int c) {
    constexpr double fine = 0.25; // longest step, in edge lengths
    constexpr int most = 100000;  // steps to a segment
    const auto &points = reference.data().points;
    const domain::Curve &curve = reference.curves()[c];
    const bool own = sizing.sharp().of_curve(c);
    CurveSteps out;
    for (int k = 0; k < curve.steps(); ++k) {
        if (keeps_corner(reference, sizing, c, k))
            out.kept.push_back(out.total);
        const int l = (k + 1) % static_cast<int>(curve.vertices.size());
        const Vec3 a = points[curve.vertices[k]] + curve.shift[k];
        const Vec3 b = points[curve.vertices[l]] + curve.shift[l];
        const double near = std::min(sizing.at(a), sizing.at(b));
        const int parts = std::clamp(static_cast<int>(std::ceil(norm(b - a) / (fine * near))), 1, most);
        for (int j = 0; j < parts; ++j) {
            const Vec3 p = a + (static_cast<double>(j) / parts) * (b - a);
            const Vec3 q = a + (static_cast<double>(j + 1) / parts) * (b - a);
            const Vec3 middle = 0.5 * (p + q);
            const domain::SharpFoot sharp = own ? domain::SharpFoot{} : sizing.cleared_by(middle);
            const double length = norm(q - p) / (sharp.edge < 0 ? sizing.at(middle) : sizing.clearance(sharp));
            out.steps.push_back({p, q, out.total, length});
            out.total += length;
        }
    }
    return out;
}

/// The ends of the parts that a curve is seeded in, each evenly: its ends, or where it is closed any point twice, and
/// the corners that it keeps.
std::vector<double> parts_of(const domain::Curve &curve, const CurveSteps &measured) {
    std::vector<double> ends = measured.kept;
    if (!curve.closed) {
        ends.insert(ends.begin(), 0.0);
        ends.push_back(measured.total);
    } else {
        ends.push_back(ends.empty() ? 0.0 : ends.front());
        ends.back() += measured.total;
        if (ends.size() == 1)
            ends.insert(ends.begin(), 0.0);
    }
    return ends;
}

void seed_curves(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing) {
    for (int c = 0; c < static_cast<int>(reference.curves().size()); ++c) {
        const domain::Curve &curve = reference.curves()[c];
        if (curve.vertices.size() < 2)
            continue;
        const CurveSteps measured = measure_curve(reference, sizing, c);
        const std::vector<double> ends = parts_of(curve, measured);
        for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
            const double length = ends[i + 1] - ends[i];
            const int least = ends.size() == 2 ? curve.least_edges() : 1;
            const int count = std::max(least, static_cast<int>(std::lround(length)));
            const bool at_end = i == 0 && !curve.closed; // where there is a corner of the surface
            for (int k = at_end ? 1 : 0; k < count; ++k) {
                const Vec3 p = measured.at(std::fmod(ends[i] + length * k / count, measured.total));
                cloud.add(p, Stratum::crease, c, sizing.at(p));
                if (k == 0 && ends.size() > 2)
                    cloud.held.back() = Hold::relaxation;
            }
        }
    }
}

/// Grows a triangular pattern over the patches from their rims, or from one point where there is no rim: each point in
/// turn offers its six neighbours, an edge length away.
class PatternGrowth {
  public:
    PatternGrowth(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing, const SeedForm &form,
                  const std::optional<PartialRenewal> &renewal, PointGrid &grid)
        : cloud_(cloud), reference_(reference), sizing_(sizing), form_(form), renewal_(renewal), grid_(grid),
          rimmed_(reference.patches(), 0) {}

    void grow(Random &random) {
        start_at_rims();
        start_elsewhere(random);
        for (std::size_t at = 0; at < queue_.size(); ++at)
            offer_neighbours(Front{queue_[at]});
    }

  private:
    struct Front {
        Vec3 point;
        Vec3 along;
        double size;
        int patch;
        int near; // a triangle there, -1: none is known
    };

    void start_at_rims() {
        for (std::size_t i = 0; i < cloud_.count(); ++i) {
            if (cloud_.role[i] != Stratum::crease || !wanted(renewal_, cloud_.points[i]))
                continue;
            const Vec3 tangent = reference_.nearest_on_curve(cloud_.points[i], cloud_.label[i]).tangent;
            for (const int patch : reference_.patches_at_curve(cloud_.label[i])) {
                queue_.push_back({cloud_.points[i], tangent, cloud_.size[i], patch, -1});
                rimmed_[patch] = 1;
            }
        }
    }

    void start_elsewhere(Random &random) {
        const auto &data = reference_.data();
        for (std::size_t t = 0; t < data.triangles.size(); ++t) {
            const int patch = data.patch[t];
            const Vec3 p = data.points[data.triangles[t][0]];
            if (rimmed_[patch] || !wanted(renewal_, p))
                continue;
            rimmed_[patch] = 1;
            const double turn = 2.0 * std::numbers::pi * random.uniform();
            const Vec3 u = domain::across(reference_.normal(static_cast<int>(t)));
            const Vec3 v = cross(reference_.normal(static_cast<int>(t)), u);
            put(p, std::cos(turn) * u + std::sin(turn) * v, patch, static_cast<int>(t));
        }
    }

    /// A new point, unless others crowd it; it will offer neighbours in its turn.
    void put(const Vec3 &p, const Vec3 &along, int patch, int near) {
        const double size = sizing_.at(p);
        if (grid_.crowded(p, form_.front_spacing * size))
            return;
        grid_.add(p, form_.front_spacing * size);
        cloud_.add(p, Stratum::patch, patch, size);
        queue_.push_back({p, along, size, patch, near});
    }

    void offer_neighbours(const Front &front) {
        constexpr int sides = 6;
        const domain::Foot here = reference_.nearest(front.point, front.patch, front.near);
        const Vec3 n = reference_.smooth_normal(here);
        const Vec3 u = unit(front.along - dot(front.along, n) * n);
        const Vec3 v = cross(n, u);
        for (int k = 0; k < sides; ++k) {
            const double turn = std::numbers::pi / 3.0 * k;
            int near = here.triangle;
            const auto p = reach(front, std::cos(turn) * u + std::sin(turn) * v, near);
            if (p && wanted(renewal_, *p))
                put(*p, *p - front.point, front.patch, near);
        }
    }

    /// The point of the patch an edge length away in this direction, or none where the patch ends before.
    std::optional<Vec3> reach(const Front &front, const Vec3 &direction, int &near) const {
        constexpr double off = 0.2; // how far off the patch it may be, in edge lengths
        Vec3 p = front.point + front.size * direction;
        const double middle = sizing_.at(0.5 * (front.point + p));
        p = front.point + middle * direction;
        domain::Foot foot = reference_.nearest(p, front.patch, near);
        p = front.point + middle * unit(foot.point - front.point);
        foot = reference_.nearest(p, front.patch, foot.triangle);
        near = foot.triangle;
        return foot.distance < off * middle ? std::optional(foot.point) : std::nullopt;
    }

    Cloud &cloud_;
    const domain::Reference &reference_;
    const domain::Sizing &sizing_;
    const SeedForm &form_;
    const std::optional<PartialRenewal> &renewal_;
    PointGrid &grid_;
    std::vector<Front> queue_;
    std::vector<char> rimmed_; // per patch: whether it has a point to grow from
};

/// A random point of a patch.
struct Dart {
    Vec3 point;
    double size;
    int patch;
    double order;
};

/// Throws darts at the triangles of patches, each as many as its area has squared edge lengths.
class DartThrower {
  public:
    DartThrower(const domain::Reference &reference, const domain::Sizing &sizing,
                const std::optional<PartialRenewal> &renewal, Random &random)
        : reference_(reference), sizing_(sizing), renewal_(renewal), random_(random) {}

    /// In random order.
    std::vector<Dart> darts() {
        for (int t = 0; t < static_cast<int>(reference_.data().triangles.size()); ++t)
            cut_up(t);
        std::sort(darts_.begin(), darts_.end(), [](const Dart &a, const Dart &b) { return a.order < b.order; });
        return std::move(darts_);
    }

  private:
    static constexpr double kTries = 40.0; // darts per edge length squared: few holes are left
    static constexpr double kPart = 2.0;   // longest edge of a part of a triangle, in edge lengths
    static constexpr int kMostCuts = 64;   // parts to a triangle's edge

    /// A triangle larger than its sizes is cut up, so that graded sizes get their share of darts.
    void cut_up(int t) {
        const auto &data = reference_.data();
        const auto &[a, b, c] = data.triangles[t];
        const std::array<Vec3, 3> corners{data.points[a], data.points[b], data.points[c]};
        const auto &[pa, pb, pc] = corners;
        const Vec3 middle = (1.0 / 3.0) * (pa + pb + pc);
        const double longest = std::max({norm(pb - pa), norm(pc - pb), norm(pa - pc)});
        if (!wanted(renewal_, middle, longest))
            return;
        const double here = sizing_.at(middle);
        const int cuts = std::clamp(static_cast<int>(std::ceil(longest / (kPart * here))), 1, kMostCuts);
        for (int i = 0; i < cuts; ++i)
            for (int j = 0; j < 2 * (cuts - i) - 1; ++j) {
                const bool up = j % 2 == 0;
                const double u = static_cast<double>(i + (up ? 0 : 1)) / cuts;
                const double v = static_cast<double>(j / 2 + (up ? 0 : 1)) / cuts;
                const double step = (up ? 1.0 : -1.0) / cuts;
                const double size = cuts == 1 ? here : sizing_.at(at(corners, u + step / 3.0, v + step / 3.0));
                carried_ += kTries * reference_.area(t) / (cuts * cuts * size * size);
                throw_at(corners, u, v, step, size, data.patch[t]);
            }
    }

    /// At the part of a triangle that starts at (u, v) and is `step` of it.
    void throw_at(const std::array<Vec3, 3> &corners, double u0, double v0, double step, double size, int patch) {
        for (; carried_ >= 1.0; carried_ -= 1.0) {
            double u = random_.uniform();
            double v = random_.uniform();
            if (u + v > 1.0) {
                u = 1.0 - u;
                v = 1.0 - v;
            }
            const Vec3 p = at(corners, u0 + step * u, v0 + step * v);
            darts_.push_back({p, size, patch, random_.uniform()});
        }
    }

    static Vec3 at(const std::array<Vec3, 3> &corners, double u, double v) {
        return corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
    }

    const domain::Reference &reference_;
    const domain::Sizing &sizing_;
    const std::optional<PartialRenewal> &renewal_;
    Random &random_;
    std::vector<Dart> darts_;
    double carried_ = 0.0; // parts of darts, so that many small triangles get their share of them too
};

void seed_patches(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing, const SeedForm &form,
                  const std::optional<PartialRenewal> &renewal, Random &random) {
    constexpr double surely = 0.9; // sizes vary little over so short a way as to a point this much closer
    PointGrid grid;
    for (std::size_t i = 0; i < cloud.count(); ++i)
        grid.add(cloud.points[i], form.patch_spacing * cloud.size[i]);
    PatternGrowth(cloud, reference, sizing, form, renewal, grid).grow(random);
    for (Dart &dart : DartThrower(reference, sizing, renewal, random).darts()) {
        if (grid.crowded(dart.point, surely * form.patch_spacing * dart.size))
            continue;
        dart.size = sizing.at(dart.point);
        const double radius = form.patch_spacing * dart.size;
        if (!grid.crowded(dart.point, radius)) {
            grid.add(dart.point, radius);
            cloud.add(dart.point, Stratum::patch, dart.patch, dart.size);
        }
    }
}

/// Lattice points of one level, found by cutting space into blocks and dropping those that cannot hold any.
class LatticeLevel {
  public:
    LatticeLevel(const domain::Reference &reference, const domain::RegionMap &map, const domain::Sizing &sizing,
                 const SeedForm &form, const std::optional<PartialRenewal> &renewal, int level,
                 const LatticeLevels &levels)
        : reference_(reference), map_(map), sizing_(sizing), form_(form), renewal_(renewal), cell_(levels.cell(level)),
          level_(level), levels_(levels) {}

    template <class Take> void collect(const geometry::Box &box, const Take &take) const {
        const Vec3 extent = box.hi - box.lo;
        const double longest = std::max({extent.x, extent.y, extent.z});
        std::int64_t side = 4;
        while (static_cast<double>(side) * cell_ < longest + cell_)
            side *= 2;
        descend(box.lo, 0, 0, 0, side, take);
    }

  private:
    template <class Take>
    void descend(const Vec3 &origin, std::int64_t i, std::int64_t j, std::int64_t k, std::int64_t side,
                 const Take &take) const {
        const double half = 0.5 * static_cast<double>(side) * cell_;
        const Vec3 center = origin + Vec3{static_cast<double>(i) * cell_ + half, static_cast<double>(j) * cell_ + half,
                                          static_cast<double>(k) * cell_ + half};
        const double radius = 1.7321 * half;
        if (!wanted(renewal_, center, radius))
            return;
        const domain::Foot foot = reference_.nearest(center);
        if (foot.distance > radius && map_.region(center, foot) < 0)
            return;
        if (levels_.count() > 1) {
            const double size = sizing_.at(center);
            const double change = sizing_.form().inner_grade * radius;
            if (levels_.of(std::max(size - change, 1e-3 * size)) > level_ || levels_.of(size + change) < level_)
                return;
        }
        if (side > 4) {
            const std::int64_t h = side / 2;
            for (int part = 0; part < 8; ++part)
                descend(origin, i + (part & 1 ? h : 0), j + (part & 2 ? h : 0), k + (part & 4 ? h : 0), h, take);
            return;
        }
        int hint = foot.triangle;
        for (std::int64_t a = i; a < i + side; ++a)
            for (std::int64_t b = j; b < j + side; ++b)
                for (std::int64_t c = k; c < k + side; ++c)
                    for (const double shift : {0.0, 0.5}) {
                        // The lattice starts a little off the box, so that a box's own faces meet no lattice plane.
                        const Vec3 p = origin + cell_ * Vec3{static_cast<double>(a) + shift - 0.363,
                                                             static_cast<double>(b) + shift - 0.363,
                                                             static_cast<double>(c) + shift - 0.363};
                        try_point(p, hint, take);
                    }
    }

    template <class Take> void try_point(const Vec3 &p, int &hint, const Take &take) const {
        const double size = sizing_.at(p);
        if (levels_.of(size) != level_)
            return;
        const domain::Foot foot = reference_.nearest(p, -1, hint);
        hint = foot.triangle;
        const auto &[behind, before] = reference_.data().sides[reference_.data().patch[foot.triangle]];
        const double depth = behind < 0 || before < 0 ? form_.least_depth : form_.interface_depth;
        if (foot.distance <= depth * cell_)
            return;
        const int region = map_.region(p, foot);
        if (region >= 0)
            take(p, size, region);
    }

    const domain::Reference &reference_;
    const domain::RegionMap &map_;
    const domain::Sizing &sizing_;
    const SeedForm &form_;
    const std::optional<PartialRenewal> &renewal_;
    double cell_;
    int level_;
    const LatticeLevels &levels_;
};

} // namespace

void seed_inside(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
                 const domain::Sizing &sizing, const SeedForm &form, const std::optional<PartialRenewal> &renewal,
                 Random &random) {
    geometry::Box box;
    for (const Vec3 &p : reference.data().points)
        box.add(p);
    std::vector<double> sizes = cloud.size;
    double finest = sizing.smallest();
    double least = finest;
    if (!sizes.empty()) { // a few outliers must not set the lattice's scale
        std::sort(sizes.begin(), sizes.end());
        finest = sizes[sizes.size() / 50];
        least = sizes.front();
    }
    const LatticeLevels levels(sizing, finest, least, form.edge_per_cell, form.level_ratio);
    PointGrid wires; // the lattice keeps off what no surface tells of
    const std::vector<char> wire = on_wires(cloud, reference);
    for (std::size_t i = 0; i < wire.size(); ++i)
        if (wire[i] || cloud.role[i] == Stratum::interior) // these are at corners
            wires.add(cloud.points[i], form.wire_gap * cloud.size[i]);
    PointGrid grid;
    for (int level = 0; level < levels.count(); ++level) {
        const double cell = levels.cell(level);
        // Points of finer levels keep points of this one at a distance of a share of their mean cell.
        std::vector<Vec3> fresh;
        LatticeLevel(reference, map, sizing, form, renewal, level, levels)
            .collect(box, [&](const Vec3 &p, double size, int region) {
                if (wires.crowded(p, form.wire_gap * size) || (level > 0 && grid.crowded(p, form.level_gap * cell)))
                    return;
                cloud.add(p + (form.jitter * size) * in_cube(random), Stratum::interior, region, size);
                fresh.push_back(p);
            });
        for (const Vec3 &p : fresh)
            grid.add(p, form.level_gap * cell);
    }
}

Cloud make_seeds(const domain::Reference &reference, const domain::RegionMap &map, const domain::Sizing &sizing,
                 const SeedForm &form, const std::optional<PartialRenewal> &renewal, const HeldSurface *held,
                 Random &random, const Workers &workers) {
    Cloud cloud;
    for (const int v : reference.data().corners)
        cloud.add(reference.data().points[v], Stratum::corner, v, sizing.at(reference.data().points[v]));
    seed_curves(cloud, reference, sizing);
    if (held)
        held->put(cloud, sizing);
    seed_sharp_rows(cloud, reference, sizing);
    seed_corners(cloud, reference, map, sizing);
    seed_patches(cloud, reference, sizing, form, renewal, random);
    seed_inside(cloud, reference, map, sizing, form, renewal, random);
    seed_walls(cloud, reference, map, sizing, 1.0 / form.edge_per_cell, workers);
    retract(cloud, reference, workers);
    clear_sharp(cloud, sizing);
    if (held) {
        held->drop_others(cloud);
        held->clear(cloud);
    }
    return cloud;
}

} // namespace wct::sampling
