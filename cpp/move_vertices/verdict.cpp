#include "move_vertices/verdict.h"

#include "geometry/predicates.h"

#include <algorithm>
#include <cmath>

namespace wct::move_vertices {

namespace {

struct Finding {
    std::size_t tet;
    bool positive;
    bool well_centered;
    bool acute;
    double worst;
};

/// Floating point decides by a margin above its rounding; nearer than that the exact predicates do.
template <class Visit>
void inspect(std::span<const Vec3> points, std::span<const Tet> tets, bool cosines, Visit visit) {
    constexpr double sure = 1e-6;
    constexpr double flat = 1e-9; // flatter tets have no digits to spare
    energy::TetLanes lanes;
    energy::WorstLanes worst;
    std::vector<std::int32_t> which;
    for (std::size_t first = 0; first < tets.size(); first += energy::kLanes) {
        const std::size_t count = std::min<std::size_t>(energy::kLanes, tets.size() - first);
        which.clear();
        for (std::size_t k = 0; k < count; ++k)
            which.push_back(static_cast<std::int32_t>(first + k));
        load_tets(points, tets, which, lanes);
        energy::measure_worst(lanes, cosines, worst);
        for (std::size_t k = 0; k < count; ++k) {
            const int lane = static_cast<int>(k);
            const auto at = [&](std::size_t i) -> const Vec3 & {
                return points[static_cast<std::size_t>(tets[first + k][i])];
            };
            Finding f{first + k, true, worst.height[lane] > 0.0, worst.cosine[lane] > 0.0,
                      std::min(worst.height[lane], worst.cosine[lane])};
            if (std::isnan(f.worst)) // flat beyond floating point
                f.worst = -1.0;
            if (!geometry::surely_positive(worst.flatness[lane]))
                f.positive = geometry::orient3d(at(0), at(1), at(2), at(3)) > 0;
            const bool doubtful = !(worst.flatness[lane] > flat);
            if (doubtful || std::fabs(worst.height[lane]) < sure)
                f.well_centered = f.positive && geometry::contains_circumcenter(at(0), at(1), at(2), at(3));
            if (cosines && (doubtful || std::fabs(worst.cosine[lane]) < sure))
                f.acute = geometry::acute(at(1), at(2), at(3)) && geometry::acute(at(0), at(2), at(3)) &&
                          geometry::acute(at(0), at(1), at(3)) && geometry::acute(at(0), at(1), at(2));
            visit(f);
        }
    }
}

} // namespace

Verdict PositionJudge::judge(std::span<const Vec3> points, std::span<const Tet> tets) const {
    Verdict out;
    inspect(points, tets, goal_ == Goal::completely_well_centered, [&](const Finding &f) {
        out.well_centered += f.well_centered;
        out.meeting += f.well_centered && f.acute;
        out.worst = std::min(out.worst, f.worst);
        out.shortfall += std::clamp(margin_ - f.worst, 0.0, margin_);
        out.valid = out.valid && f.positive;
    });
    return out;
}

std::vector<bool> PositionJudge::meeting(std::span<const Vec3> points, std::span<const Tet> tets) const {
    std::vector<bool> out(tets.size());
    inspect(points, tets, goal_ == Goal::completely_well_centered,
            [&](const Finding &f) { out[f.tet] = f.well_centered && f.acute; });
    return out;
}

bool PositionJudge::better(const Verdict &candidate, const Verdict &best, const Verdict &start,
                           std::size_t tets) const {
    if (!candidate.valid || candidate.well_centered < start.well_centered)
        return false;
    if (start.meeting == static_cast<std::int64_t>(tets) && candidate.worst < start.worst - kRounding)
        return false;
    if (candidate.meeting != best.meeting)
        return candidate.meeting > best.meeting;
    return candidate.shortfall < best.shortfall;
}

} // namespace wct::move_vertices
