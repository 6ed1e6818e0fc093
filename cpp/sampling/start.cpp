#include "sampling/start.h"

namespace wct::sampling {

Start start_of(const Resampled &result, const SurfaceLabels &surface) {
    const Cloud &cloud = result.cloud;
    const auto &tets = result.complex.all.tets;
    Start start;
    search::StratifiedMesh &mesh = start.mesh;
    start.place.assign(cloud.count(), -1);
    for (std::size_t t = 0; t < tets.size(); ++t)
        if (result.complex.region[t] >= 0)
            for (const int v : tets[t])
                start.place[v] = 0;
    for (std::size_t i = 0; i < cloud.count(); ++i) {
        if (start.place[i] < 0)
            continue;
        start.place[i] = static_cast<int>(mesh.points.size());
        mesh.points.push_back(cloud.points[i]);
        mesh.stratum.push_back(cloud.role[i]);
        mesh.label.push_back(cloud.role[i] == Stratum::interior ? -1 : cloud.label[i]);
        mesh.size.push_back(cloud.size[i]);
    }
    const auto placed = [&](auto cell) {
        for (auto &v : cell)
            v = start.place[v];
        return cell;
    };
    for (std::size_t t = 0; t < tets.size(); ++t)
        if (result.complex.region[t] >= 0) {
            mesh.tets.push_back(placed(tets[t]));
            mesh.region.push_back(result.complex.region[t]);
        }
    for (const Facet &facet : surface.facets)
        mesh.facets.push_back(placed(facet));
    mesh.facet_patch = surface.patch;
    for (const Edge &edge : surface.creases)
        mesh.creases.push_back(placed(edge));
    mesh.crease_curve = surface.curve;
    return start;
}

} // namespace wct::sampling
