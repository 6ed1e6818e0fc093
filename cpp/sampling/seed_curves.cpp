#include "sampling/seed_curves.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace wct::sampling {

namespace {

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

/// Finds the creases along layers whose points are to be half a step off those of the crease on the layer's other side.
///
/// Facets on the rim of a layer of one row go from one of its creases to the other, and are acute only where points of
/// one lie opposite the middles between points of the other. Where an interface is on one side, the search can mend
/// that only together with the tets beyond; plates by themselves come right as they are. Short creases have no room.
class ShiftedCreases {
  public:
    ShiftedCreases(const domain::Reference &reference, const domain::Sizing &sizing)
        : reference_(reference), sizing_(sizing) {
        const int count = static_cast<int>(reference.curves().size());
        std::vector<double> thick(count, 0.0); // of the layer along a crease, 0 where it has none
        for (int c = 0; c < count; ++c)
            thick[c] = layer_along(c);
        shifted_.assign(count, 0);
        for (int c = 0; c < count; ++c)
            for (int d = 0; d < c && thick[c] > 0.0; ++d)
                if (thick[d] > 0.0 && !shifted_[d] && are_opposite(c, d, thick[c]))
                    shifted_[c] = 1;
    }

    bool operator[](int curve) const { return shifted_[curve] != 0; }

  private:
    static constexpr double kLong = 12.0;    // least length, in thicknesses
    static constexpr double kOpposite = 1.3; // how far off the other crease may be, in thicknesses

    double layer_along(int c) const {
        const domain::Curve &curve = reference_.curves()[c];
        if (curve.closed || curve.vertices.size() < 2)
            return 0.0;
        const double layer = sizing_.layer(curve);
        return reference_.length(c) > kLong * layer ? layer : 0.0;
    }

    bool are_opposite(int c, int d, double thick) const {
        const domain::Curve &curve = reference_.curves()[c];
        const int step = curve.steps() / 2;
        const Vec3 middle =
            curve.steps() % 2 == 0 ? point(curve.at(step)) : 0.5 * (point(curve.at(step)) + point(curve.at(step + 1)));
        return (on_interface(c) || on_interface(d)) && reference_.share_patch(c, d) &&
               reference_.nearest_on_curve(middle, d).distance < kOpposite * thick;
    }

    bool on_interface(int c) const { return reference_.any_inner(reference_.patches_at_curve(c)); }

    const Vec3 &point(int vertex) const { return reference_.data().points[vertex]; }

    const domain::Reference &reference_;
    const domain::Sizing &sizing_;
    std::vector<char> shifted_; // per curve
};

} // namespace

void seed_curves(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing) {
    const ShiftedCreases shifted(reference, sizing);
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
            const double off = shifted[c] && ends.size() == 2 ? 0.5 : 0.0;
            for (int k = at_end && off == 0.0 ? 1 : 0; k < count; ++k) {
                const Vec3 p = measured.at(std::fmod(ends[i] + length * (k + off) / count, measured.total));
                cloud.add(p, Stratum::crease, c, sizing.at(p));
                if (k == 0 && ends.size() > 2)
                    cloud.held.back() = Hold::descent;
            }
        }
    }
}

} // namespace wct::sampling
