#include "sampling/corner_spokes.h"

namespace wct::sampling {

std::map<int, std::vector<Spoke>> spokes_of(const std::vector<std::vector<CurveStop>> &chains,
                                            const domain::Reference &reference) {
    std::map<int, std::vector<Spoke>> spokes;
    for (int c = 0; c < static_cast<int>(chains.size()); ++c) {
        const auto &chain = chains[c];
        if (chain.size() < 2 || reference.curves()[c].closed)
            continue;
        const int steps = static_cast<int>(chain.size()) - 1;
        spokes[chain.front().point].push_back({c, chain[1].point, steps});
        spokes[chain.back().point].push_back({c, chain[chain.size() - 2].point, steps});
    }
    return spokes;
}

void put_at(Cloud &cloud, const domain::Reference &reference, int corner, const Spoke &spoke, double distance) {
    if (cloud.held[spoke.point] == Hold::given)
        return;
    const Vec3 at = cloud.points[corner];
    Vec3 &p = cloud.points[spoke.point];
    p = reference.nearest_on_curve(at + distance * unit(p - at), spoke.curve, true).point;
}

} // namespace wct::sampling
