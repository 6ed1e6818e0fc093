#include "move_vertices/moving_mesh.h"

#include "geometry/predicates.h"

#include <algorithm>
#include <cmath>

namespace wct::move_vertices {

namespace {

/// Even permutations that bring each corner to the front: they keep a positive tet positive.
constexpr int kFront[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}};

/// Lowest flatness a tet may come down to, given the one it starts from. The allowance covers the rounding by which
/// the same tet measures differently from another corner; exact signs watch over what remains.
double lowest(double flatness) {
    return std::min(kFlattest, flatness - 1e-9 * std::fabs(flatness) - 1e-14);
}

} // namespace

MovingMesh::MovingMesh(std::vector<Vec3> start, std::vector<Tet> tets, const std::vector<bool> &free)
    : points(std::move(start)), tets_(std::move(tets)), offsets_(points.size() + 1, 0), floors_(tets_.size()),
      sizes_(points.size(), 0.0) {
    for (std::size_t t = 0; t < tets_.size(); ++t) {
        bool any = false;
        for (const auto corner : tets_[t])
            if (free[static_cast<std::size_t>(corner)]) {
                ++offsets_[static_cast<std::size_t>(corner) + 1];
                any = true;
            }
        if (any)
            active_.push_back(static_cast<std::int32_t>(t));
    }
    for (std::size_t p = 0; p < points.size(); ++p) {
        if (offsets_[p + 1])
            free_.push_back(static_cast<std::int32_t>(p));
        offsets_[p + 1] += offsets_[p];
    }
    stars_.resize(offsets_.back());
    std::vector<std::size_t> next(offsets_.begin(), offsets_.end() - 1);
    for (const auto t : active_) {
        const Tet &tet = tets_[static_cast<std::size_t>(t)];
        for (const auto &order : kFront) {
            const auto corner = static_cast<std::size_t>(tet[static_cast<std::size_t>(order[0])]);
            if (free[corner])
                stars_[next[corner]++] = {t,
                                          {tet[static_cast<std::size_t>(order[1])],
                                           tet[static_cast<std::size_t>(order[2])],
                                           tet[static_cast<std::size_t>(order[3])]}};
        }
    }
    for (const auto p : free_) {
        const auto around = star(p);
        const Vec3 &x = points[static_cast<std::size_t>(p)];
        double sum = 0.0;
        for (const StarTet &s : around)
            for (const auto o : s.other)
                sum += norm(points[static_cast<std::size_t>(o)] - x);
        sizes_[static_cast<std::size_t>(p)] = sum / (3.0 * static_cast<double>(around.size()));
    }
    energy::TetLanes lanes;
    energy::WorstLanes worst;
    for (std::size_t first = 0; first < active_.size(); first += energy::kLanes) {
        const std::size_t count = std::min<std::size_t>(energy::kLanes, active_.size() - first);
        const std::span which(active_.data() + first, count);
        load_tets(points, tets_, which, lanes);
        energy::measure_worst(lanes, false, worst);
        for (std::size_t lane = 0; lane < count; ++lane)
            floors_[static_cast<std::size_t>(which[lane])] = lowest(worst.flatness[static_cast<int>(lane)]);
    }
}

bool MovingMesh::positive(std::int32_t tet, double flatness, std::span<const Vec3> at) const {
    if (geometry::surely_positive(flatness))
        return true;
    const Tet &t = tets_[static_cast<std::size_t>(tet)];
    return geometry::orient3d(at[static_cast<std::size_t>(t[0])], at[static_cast<std::size_t>(t[1])],
                              at[static_cast<std::size_t>(t[2])], at[static_cast<std::size_t>(t[3])]) > 0;
}

void load_tets(std::span<const Vec3> points, std::span<const Tet> tets, std::span<const std::int32_t> which,
               energy::TetLanes &lanes) {
    for (std::size_t lane = 0; lane < energy::kLanes; ++lane) {
        const Tet &tet = tets[static_cast<std::size_t>(which[std::min(lane, which.size() - 1)])];
        for (std::size_t i = 0; i < 4; ++i)
            lanes.set(static_cast<int>(lane), static_cast<int>(i), points[static_cast<std::size_t>(tet[i])]);
    }
}

} // namespace wct::move_vertices
