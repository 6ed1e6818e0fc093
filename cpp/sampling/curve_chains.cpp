#include "sampling/curve_chains.h"

#include <algorithm>
#include <map>

namespace wct::sampling {

std::vector<std::vector<CurveStop>> curve_chains(const Cloud &cloud, const domain::Reference &reference) {
    std::vector<std::vector<CurveStop>> chains(reference.curves().size());
    std::map<int, int> corner; // vertex of the reference -> point
    for (std::size_t i = 0; i < cloud.count(); ++i) {
        if (cloud.role[i] == Stratum::corner)
            corner[cloud.label[i]] = static_cast<int>(i);
        if (cloud.role[i] != Stratum::crease)
            continue;
        const domain::CurveFoot foot = reference.nearest_on_curve(cloud.points[i], cloud.label[i], true);
        chains[cloud.label[i]].push_back({foot.step + foot.along, static_cast<int>(i)});
    }
    for (std::size_t c = 0; c < chains.size(); ++c) {
        const domain::Curve &curve = reference.curves()[c];
        if (curve.vertices.size() < 2)
            continue;
        auto &chain = chains[c];
        std::sort(chain.begin(), chain.end(), [](const CurveStop &a, const CurveStop &b) { return a.at < b.at; });
        const auto steps = static_cast<double>(curve.steps());
        const auto end_stop = [&](int vertex, double at) {
            const auto found = corner.find(vertex);
            return found == corner.end() ? std::vector<CurveStop>{} : std::vector<CurveStop>{{at, found->second}};
        };
        if (curve.closed && !chain.empty()) {
            chain.push_back({chain.front().at + steps, chain.front().point});
        } else if (!curve.closed) {
            const auto first = end_stop(curve.vertices.front(), 0.0), last = end_stop(curve.vertices.back(), steps);
            chain.insert(chain.begin(), first.begin(), first.end());
            chain.insert(chain.end(), last.begin(), last.end());
        }
    }
    return chains;
}

} // namespace wct::sampling
