#include "sampling/seed_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace wct::sampling {

namespace {

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

} // namespace

void seed_patches(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing, const SeedForm &form,
                  const std::optional<PartialRenewal> &renewal, Random &random, Monitor &monitor) {
    constexpr int hear = 1 << 14;  // darts after which who may stop the work is asked
    constexpr double surely = 0.9; // sizes vary little over so short a way as to a point this much closer
    PointGrid grid;
    for (std::size_t i = 0; i < cloud.count(); ++i)
        grid.add(cloud.points[i], form.patch_spacing * cloud.size[i]);
    PatternGrowth(cloud, reference, sizing, form, renewal, grid).grow(random);
    int thrown = 0;
    for (Dart &dart : DartThrower(reference, sizing, renewal, random).darts()) {
        if (++thrown % hear == 0)
            monitor.ask();
        if (monitor.stopped())
            return;
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

} // namespace wct::sampling
