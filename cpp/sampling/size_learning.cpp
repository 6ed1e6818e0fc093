#include "sampling/size_learning.h"

#include <algorithm>
#include <cmath>

namespace wct::sampling {

namespace {

// Of a size, by one deviation measured.
constexpr double least_change = 0.7;
constexpr double most_change = 1.08;

} // namespace

void set_offsets(domain::Reference &reference, const domain::Sizing &sizing, const ResampleOptions &options,
                 const std::vector<double> &correction) {
    constexpr double irregular = 1.4; // how much deeper than an equilateral facet an irregular one may sag
    constexpr double crease = 1.33;   // offset of crease points, relative to what a patch that bends so would have
    for (int w = 0; w < reference.wedges(); ++w) {
        const auto &k = reference.curvature(w);
        const double size = sizing.surface[reference.wedge_vertex(w)];
        const double most = options.shell * options.sizing.tolerance_at(reference.wedge_vertex(w));
        // (k1 + k2) size^2 / 16 is the mean sag of an equilateral facet, and keeps the volume; half of what an
        // irregular one may sag centers it in the tolerance.
        const double mean = k[0] + k[1];
        const double deep = domain::unit_sag(k[0], k[1]) * 8.0;
        const double middle = irregular * (k[0] * k[1] > 0.0 ? (k[0] > 0.0 ? deep : -deep) : mean);
        const double half = 0.5 * (mean + middle);
        const double offset = options.offset * half * size * size / 16.0 + correction[reference.wedge_vertex(w)];
        reference.offset[w] = std::clamp(offset, -most, most);
    }
    for (std::size_t c = 0; c < reference.curves().size(); ++c) {
        domain::Curve &curve = reference.curves()[c];
        if (reference.bare(static_cast<int>(c))) // keeps its own corners
            continue;
        for (std::size_t k = 0; k < curve.vertices.size(); ++k) {
            const double size = sizing.surface[curve.vertices[k]];
            const double most = options.shell * options.sizing.tolerance_at(curve.vertices[k]);
            const Vec3 shift = (-crease * options.offset * size * size / 16.0) * curve.bend[k];
            const double far = norm(shift);
            curve.shift[k] = far > most ? (most / far) * shift : shift;
        }
        if (!curve.closed && !curve.vertices.empty())
            curve.shift.front() = curve.shift.back() = {}; // corners stay
    }
    reference.rebuild_curves();
}

void learn(const Deviation &deviation, domain::Sizing &sizing, std::vector<double> &correction,
           const std::vector<double> &ceiling, const ResampleOptions &options) {
    constexpr double one_sided =
        0.75; // what of a deviation to one side alone counts, as offsets take care of some of it
    for (std::size_t v = 0; v < correction.size(); ++v) {
        const double tolerance = options.sizing.tolerance_at(static_cast<int>(v));
        const double up = deviation.above[v];
        const double down = deviation.below[v];
        // Offsets keep the volume as they are; only what leaves the tolerance is a reason to shift them.
        const double excess = std::max(0.0, std::max(up, -down) - options.target * tolerance);
        correction[v] += std::clamp(-0.5 * (up + down), -excess, excess);
        const double half = std::max(0.5 * (up - down), one_sided * std::max({up, -down, deviation.missed[v]}));
        const double change = half > 0.0 ? std::sqrt(options.target * tolerance / half) : 2.0;
        sizing.surface[v] = std::min(sizing.surface[v] * std::clamp(change, least_change, most_change), ceiling[v]);
    }
    sizing.grade();
}

void shrink(const Deviation &deviation, domain::Sizing &sizing, const ResampleOptions &options) {
    for (std::size_t v = 0; v < sizing.surface.size(); ++v) {
        const double tolerance = options.sizing.tolerance_at(static_cast<int>(v));
        const double far = std::max({deviation.above[v], -deviation.below[v], deviation.missed[v]});
        if (far > options.held * tolerance)
            sizing.surface[v] *= std::max(std::sqrt(options.target * tolerance / far), least_change);
    }
    sizing.grade();
}

void refine(const Cloud &cloud, const std::vector<int> &touched, const domain::Reference &reference,
            domain::Sizing &sizing) {
    constexpr double share = 0.6;
    for (const int i : touched) {
        const domain::Foot foot = reference.nearest(cloud.points[i]);
        for (const int v : reference.data().triangles[foot.triangle]) {
            const double far = norm(reference.data().points[v] - foot.point);
            sizing.surface[v] = std::min(sizing.surface[v], share * cloud.size[i] + sizing.form().surface_grade * far);
        }
    }
    sizing.grade();
}

} // namespace wct::sampling
