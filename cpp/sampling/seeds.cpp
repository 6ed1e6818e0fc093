#include "sampling/seeds.h"

#include "sampling/lattice_levels.h"
#include "sampling/seed_corners.h"
#include "sampling/seed_walls.h"
#include "sampling/sharp_edge_rows.h"

#include <algorithm>
#include <cmath>

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

double size_at(const domain::Sizing &sizing, const Vec3 &p) {
    return sizing.at(p);
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
    return 0.5 * size_at(sizing, p) * std::sin(0.5 * turn) > sizing.form().tolerance_at(curve.vertices[k]);
}

void seed_curves(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing) {
    const auto &points = reference.data().points;
    for (std::size_t c = 0; c < reference.curves().size(); ++c) {
        const domain::Curve &curve = reference.curves()[c];
        if (curve.vertices.size() < 2)
            continue;
        const bool own = sizing.sharp().of_curve(static_cast<int>(c));
        // Arc length in units of the local edge length, on a polyline fine enough for the size field.
        struct Step {
            Vec3 from, to;
            double before, length;
        };
        std::vector<Step> steps;
        double total = 0.0;
        std::vector<double> kept; // where the curve's own corners are
        for (int k = 0; k < curve.steps(); ++k) {
            if (keeps_corner(reference, sizing, static_cast<int>(c), k))
                kept.push_back(total);
            const int l = (k + 1) % static_cast<int>(curve.vertices.size());
            const Vec3 a = points[curve.vertices[k]] + curve.shift[k];
            const Vec3 b = points[curve.vertices[l]] + curve.shift[l];
            const double near = std::min(size_at(sizing, a), size_at(sizing, b));
            const int parts = std::clamp(static_cast<int>(std::ceil(norm(b - a) / (0.25 * near))), 1, 100000);
            for (int j = 0; j < parts; ++j) {
                const Vec3 p = a + (static_cast<double>(j) / parts) * (b - a);
                const Vec3 q = a + (static_cast<double>(j + 1) / parts) * (b - a);
                const Vec3 middle = 0.5 * (p + q);
                const domain::SharpFoot sharp = own ? domain::SharpFoot{} : sizing.cleared_by(middle);
                const double length =
                    norm(q - p) / (sharp.edge < 0 ? size_at(sizing, middle) : sizing.clearance(sharp));
                steps.push_back({p, q, total, length});
                total += length;
            }
        }
        const auto put = [&](double wanted) {
            const auto after = std::partition_point(steps.begin(), steps.end() - 1,
                                                    [&](const Step &s) { return s.before + s.length < wanted; });
            const double t = after->length > 0.0 ? (wanted - after->before) / after->length : 0.0;
            const Vec3 p = after->from + t * (after->to - after->from);
            cloud.add(p, Stratum::crease, static_cast<int>(c), size_at(sizing, p));
        };
        // Evenly from one of them to the next.
        if (!curve.closed) {
            kept.insert(kept.begin(), 0.0);
            kept.push_back(total);
        } else {
            kept.push_back(kept.empty() ? 0.0 : kept.front());
            kept.back() += total;
            if (kept.size() == 1)
                kept.insert(kept.begin(), 0.0);
        }
        for (std::size_t i = 0; i + 1 < kept.size(); ++i) {
            const double length = kept[i + 1] - kept[i];
            const int least = kept.size() == 2 ? curve.least_edges() : 1;
            const int count = std::max(least, static_cast<int>(std::lround(length)));
            const bool at_end = i == 0 && !curve.closed; // where there is a corner of the surface
            for (int k = at_end ? 1 : 0; k < count; ++k) {
                put(std::fmod(kept[i] + length * k / count, total));
                if (k == 0 && kept.size() > 2)
                    cloud.held.back() = Hold::relaxation;
            }
        }
    }
}

/// Grow a triangular pattern over the patches from their rims, or from one point where there is no rim: each point in
/// turn offers its six neighbours, an edge length away.
void grow_patches(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing, const SeedForm &form,
                  const std::optional<PartialRenewal> &renewal, PointGrid &grid, Random &random) {
    struct Front {
        Vec3 point;
        Vec3 along;
        double size;
        int patch;
        int near; // a triangle there, -1: none is known
    };
    const auto &data = reference.data();
    std::vector<Front> queue;
    std::vector<char> rimmed(reference.patches(), 0);
    for (std::size_t i = 0; i < cloud.count(); ++i) {
        if (cloud.role[i] != Stratum::crease || !wanted(renewal, cloud.points[i]))
            continue;
        const Vec3 tangent = reference.nearest_on_curve(cloud.points[i], cloud.label[i]).tangent;
        for (const int patch : reference.patches_at_curve(cloud.label[i])) {
            queue.push_back({cloud.points[i], tangent, cloud.size[i], patch, -1});
            rimmed[patch] = 1;
        }
    }
    for (std::size_t t = 0; t < data.triangles.size(); ++t) {
        const int patch = data.patch[t];
        const Vec3 p = data.points[data.triangles[t][0]];
        if (rimmed[patch] || !wanted(renewal, p))
            continue;
        rimmed[patch] = 1;
        const double size = size_at(sizing, p);
        const double turn = 6.283185307179586 * random.uniform();
        const Vec3 u = domain::across(reference.normal(static_cast<int>(t)));
        const Vec3 v = cross(reference.normal(static_cast<int>(t)), u);
        if (grid.crowded(p, form.front_spacing * size))
            continue;
        grid.add(p, form.front_spacing * size);
        cloud.add(p, Stratum::patch, patch, size);
        queue.push_back({p, std::cos(turn) * u + std::sin(turn) * v, size, patch, static_cast<int>(t)});
    }
    for (std::size_t at = 0; at < queue.size(); ++at) {
        const Front front = queue[at];
        const domain::Foot here = reference.nearest(front.point, front.patch, front.near);
        const Vec3 n = reference.smooth_normal(here);
        const Vec3 u = unit(front.along - dot(front.along, n) * n);
        const Vec3 v = cross(n, u);
        for (int k = 0; k < 6; ++k) {
            const double turn = 1.0471975511965976 * k;
            const Vec3 d = std::cos(turn) * u + std::sin(turn) * v;
            Vec3 p = front.point + front.size * d;
            const double middle = size_at(sizing, 0.5 * (front.point + p));
            bool found = true;
            int near = here.triangle;
            for (int pass = 0; pass < 2 && found; ++pass) {
                p = front.point + middle * (pass == 0 ? d : unit(p - front.point));
                const domain::Foot foot = reference.nearest(p, front.patch, near);
                near = foot.triangle;
                found = pass == 0 || foot.distance < 0.2 * middle;
                p = foot.point;
            }
            if (!found)
                continue;
            const double size = size_at(sizing, p);
            if (!wanted(renewal, p) || grid.crowded(p, form.front_spacing * size))
                continue;
            grid.add(p, form.front_spacing * size);
            cloud.add(p, Stratum::patch, front.patch, size);
            queue.push_back({p, p - front.point, size, front.patch, near});
        }
    }
}

void seed_patches(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing, const SeedForm &form,
                  const std::optional<PartialRenewal> &renewal, Random &random) {
    constexpr double kTries = 40.0; // darts per edge length squared: few holes are left
    const auto &data = reference.data();
    PointGrid grid;
    for (std::size_t i = 0; i < cloud.count(); ++i)
        grid.add(cloud.points[i], form.patch_spacing * cloud.size[i]);
    grow_patches(cloud, reference, sizing, form, renewal, grid, random);
    struct Dart {
        Vec3 point;
        double size;
        int patch;
        double order;
    };
    std::vector<Dart> darts;
    double carried = 0.0; // so that many small triangles get their share of darts too
    for (std::size_t t = 0; t < data.triangles.size(); ++t) {
        const auto &[a, b, c] = data.triangles[t];
        const Vec3 &pa = data.points[a];
        const Vec3 &pb = data.points[b];
        const Vec3 &pc = data.points[c];
        // A triangle larger than its sizes is cut up, so that graded sizes get their share of darts.
        const Vec3 middle = (1.0 / 3.0) * (pa + pb + pc);
        const double longest = std::max({norm(pb - pa), norm(pc - pb), norm(pa - pc)});
        if (!wanted(renewal, middle, longest))
            continue;
        const double here = size_at(sizing, middle);
        const int cuts = std::clamp(static_cast<int>(std::ceil(longest / (2.0 * here))), 1, 64);
        for (int i = 0; i < cuts; ++i)
            for (int j = 0; j < 2 * (cuts - i) - 1; ++j) {
                const bool up = j % 2 == 0;
                const double u0 = static_cast<double>(i + (up ? 0 : 1)) / cuts;
                const double v0 = static_cast<double>(j / 2 + (up ? 0 : 1)) / cuts;
                const double step = (up ? 1.0 : -1.0) / cuts;
                const auto at = [&](double u, double v) { return pa + u * (pb - pa) + v * (pc - pa); };
                const double h = cuts == 1 ? here : size_at(sizing, at(u0 + step / 3.0, v0 + step / 3.0));
                carried += kTries * reference.area(static_cast<int>(t)) / (cuts * cuts * h * h);
                for (; carried >= 1.0; carried -= 1.0) {
                    double u = random.uniform();
                    double v = random.uniform();
                    if (u + v > 1.0) {
                        u = 1.0 - u;
                        v = 1.0 - v;
                    }
                    const Vec3 p = at(u0 + step * u, v0 + step * v);
                    darts.push_back({p, h, data.patch[t], random.uniform()});
                }
            }
    }
    std::sort(darts.begin(), darts.end(), [](const Dart &a, const Dart &b) { return a.order < b.order; });
    for (Dart &dart : darts) {
        if (grid.crowded(dart.point, 0.9 * form.patch_spacing * dart.size)) // sizes vary little over so short a way
            continue;
        dart.size = size_at(sizing, dart.point);
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
        cloud.add(reference.data().points[v], Stratum::corner, v, size_at(sizing, reference.data().points[v]));
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
