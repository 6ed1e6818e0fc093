#include "search/volume_balance.h"

#include <algorithm>
#include <cmath>

namespace wct::search {

namespace {
constexpr int kSweeps = 10;
constexpr double kBalanced = 0.01; // of the tolerance
} // namespace

void SurfaceBalance::run() {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        const std::vector<double> offset = offsets();
        if (std::all_of(offset.begin(), offset.end(),
                        [&](double here) { return std::abs(here) <= kBalanced * guide_.tolerance(); }))
            return;
        bool any = false;
        for (std::size_t k = 0; k < complex_.vertex_slots(); ++k) {
            const int v = static_cast<int>(k);
            const Vertex &vertex = complex_.vertex(v);
            if (complex_.used(v) && vertex.stratum == Stratum::patch && !guide_.planar(vertex.label))
                any |= shift(v, -offset[vertex.label]);
        }
        if (!any)
            return;
    }
}

std::vector<double> SurfaceBalance::offsets() {
    std::vector<double> sum(guide_.patches(), 0.0), area(guide_.patches(), 0.0);
    for (const auto &[key, patch] : complex_.sorted_surface()) { // in order, or the sums would depend on it
        if (guide_.planar(patch))
            continue;
        const std::array<Vec3, 3> corners = complex_.corners(key);
        const double here = norm(normal_of(corners));
        sum[patch] += here * guide_.offset(patch, corners, complex_.facet(key).hints);
        area[patch] += here;
    }
    for (std::size_t patch = 0; patch < sum.size(); ++patch)
        sum[patch] = area[patch] > 0.0 ? sum[patch] / area[patch] : 0.0;
    return sum;
}

SurfaceBalance::Short SurfaceBalance::short_around(int v) const {
    Short found;
    for (int t : complex_.star(v)) {
        found.of_margin += energy_.bad(complex_.energy(t));
        found.of_goal += energy_.misses_goal(complex_.energy(t));
    }
    return found;
}

bool SurfaceBalance::shift(int v, double by) {
    const Short before = short_around(v);
    complex_.mark();
    const Vec3 x = complex_.point(v) + by * guide_.normal(complex_.vertex(v).label, complex_.point(v));
    if (descent_.nudge(v, x)) {
        const Short after = short_around(v);
        if (after.of_margin <= before.of_margin && after.of_goal <= before.of_goal) {
            complex_.commit();
            return true;
        }
    }
    complex_.rollback();
    return false;
}

} // namespace wct::search
