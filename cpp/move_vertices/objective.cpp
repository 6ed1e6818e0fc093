#include "move_vertices/objective.h"

#include <algorithm>
#include <limits>

namespace wct::move_vertices {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

} // namespace

void Objective::load_terms(const MovingMesh &mesh, std::span<const std::int32_t> tets, energy::TermLanes &terms) const {
    for (int lane = 0; lane < energy::kLanes; ++lane) {
        const auto tet = tets[std::min(static_cast<std::size_t>(lane), tets.size() - 1)];
        const auto t = static_cast<std::size_t>(tet);
        terms.flatness[lane] = mesh.floor(tet);
        terms.height[lane] = emphasis_.height.empty() ? -kInfinity : emphasis_.height[t];
        terms.cosine[lane] = emphasis_.cosine.empty() ? -kInfinity : emphasis_.cosine[t];
        terms.weight[lane] = emphasis_.weight.empty() ? 1.0 : emphasis_.weight[t];
    }
}

double Objective::total(const MovingMesh &mesh, std::span<const Vec3> at, std::span<Vec3> gradient,
                        std::size_t &work) const {
    std::fill(gradient.begin(), gradient.end(), Vec3{});
    energy::TetLanes lanes;
    energy::TermLanes terms;
    energy::ShapeLanes shape;
    energy::SlopeLanes slopes;
    energy::GradientLanes pulled;
    energy::Lanes energy;
    double sum = 0.0;
    const std::span active(mesh.active());
    for (std::size_t first = 0; first < active.size(); first += energy::kLanes) {
        const auto which = active.subspan(first, std::min<std::size_t>(energy::kLanes, active.size() - first));
        load_tets(at, mesh.tets(), which, lanes);
        load_terms(mesh, which, terms);
        energy::measure(lanes, form_.cosines(), shape);
        energy::penalize(shape, form_, terms, energy, slopes);
        work += which.size();
        for (std::size_t k = 0; k < which.size(); ++k) {
            const int lane = static_cast<int>(k);
            if (energy[lane] == kInfinity || !mesh.positive(which[k], shape.flatness[lane], at))
                return kInfinity;
            sum += energy[lane];
        }
        energy::differentiate(lanes, shape, slopes, form_.cosines(), pulled);
        for (std::size_t k = 0; k < which.size(); ++k) {
            const int lane = static_cast<int>(k);
            const Tet &tet = mesh.tets()[static_cast<std::size_t>(which[k])];
            for (std::size_t i = 0; i < 4; ++i) {
                const auto &corner = pulled.corner[i];
                gradient[static_cast<std::size_t>(tet[i])] += {corner[0][lane], corner[1][lane], corner[2][lane]};
            }
        }
    }
    return sum;
}

double Objective::star(const MovingMesh &mesh, std::int32_t point, std::vector<energy::TetLanes> &lanes, Vec3 &gradient,
                       std::size_t &work) const {
    const auto around = mesh.star(point);
    const Vec3 &x = mesh.points[static_cast<std::size_t>(point)];
    energy::TermLanes terms;
    energy::ShapeLanes shape;
    energy::SlopeLanes slopes;
    energy::Lanes energy;
    energy::Lanes pulled[3];
    double sum = 0.0;
    gradient = {};
    for (std::size_t first = 0; first < around.size(); first += energy::kLanes) {
        const std::size_t count = std::min<std::size_t>(energy::kLanes, around.size() - first);
        std::array<std::int32_t, energy::kLanes> which{};
        for (std::size_t k = 0; k < count; ++k)
            which[k] = around[first + k].tet;
        energy::TetLanes &block = lanes[first / energy::kLanes];
        block.set_all(0, x);
        load_terms(mesh, std::span(which).first(count), terms);
        energy::measure(block, form_.cosines(), shape);
        energy::penalize(shape, form_, terms, energy, slopes);
        work += count;
        for (std::size_t k = 0; k < count; ++k) {
            const int lane = static_cast<int>(k);
            if (energy[lane] == kInfinity || !mesh.positive(which[k], shape.flatness[lane], mesh.points))
                return kInfinity;
            sum += energy[lane];
        }
        energy::differentiate_first(block, shape, slopes, form_.cosines(), pulled);
        for (int lane = 0; lane < static_cast<int>(count); ++lane)
            gradient += {pulled[0][lane], pulled[1][lane], pulled[2][lane]};
    }
    return sum;
}

void load_star(const MovingMesh &mesh, std::int32_t point, std::vector<energy::TetLanes> &lanes) {
    const auto around = mesh.star(point);
    const std::size_t blocks = (around.size() + energy::kLanes - 1) / energy::kLanes;
    if (lanes.size() < blocks)
        lanes.resize(blocks);
    for (std::size_t k = 0; k < blocks * energy::kLanes; ++k) {
        const StarTet &s = around[std::min(k, around.size() - 1)];
        for (int i = 0; i < 3; ++i)
            lanes[k / energy::kLanes].set(static_cast<int>(k % energy::kLanes), i + 1,
                                          mesh.points[static_cast<std::size_t>(s.other[i])]);
    }
}

} // namespace wct::move_vertices
