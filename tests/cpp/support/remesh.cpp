#include "support/remesh.h"

#include "geometry/predicates.h"
#include "sampling/resample.h"
#include "sampling/surface_labels.h"
#include "search/crease_release.h"
#include "support/bench.h"

#include <algorithm>
#include <iterator>
#include <numeric>

namespace wct::tests {

namespace {

Start start_of(const sampling::Resampled &made, const sampling::SurfaceLabels &labels, const Body &on) {
    Start out;
    out.intact = made.intact;
    out.bad = static_cast<std::size_t>(made.tally.bad);
    std::vector<int> place(made.cloud.count(), -1);
    const auto placed = [&](int v) {
        if (place[v] < 0) {
            place[v] = static_cast<int>(out.body.points.size());
            out.body.points.push_back(made.cloud.points[v]);
            out.body.stratum.push_back(made.cloud.role[v]);
            out.body.label.push_back(made.cloud.role[v] == Stratum::interior ? -1 : made.cloud.label[v]);
            out.size.push_back(made.cloud.size[v]);
        }
        return place[v];
    };
    for (std::size_t t = 0; t < made.complex.all.tets.size(); ++t)
        if (made.complex.region[t] >= 0) {
            Tet tet = made.complex.all.tets[t];
            for (int &v : tet)
                v = placed(v);
            out.body.tets.push_back(tet);
            out.body.regions.push_back(made.complex.region[t]);
        }
    for (Facet facet : labels.facets) {
        for (int &v : facet)
            v = placed(v);
        out.body.facets.push_back(facet);
    }
    out.body.patch = labels.patch;
    for (const Edge &edge : labels.creases)
        out.body.creases.push_back(sorted(placed(edge[0]), placed(edge[1])));
    out.body.curve = labels.curve;
    out.body.sides = on.sides;
    return out;
}

} // namespace

Start resampled(const Body &body, double tolerance, unsigned threads, std::uint64_t seed) {
    domain::Reference reference(body.surface());
    const domain::InputMesh mesh = body.mesh();
    sampling::ResampleOptions options;
    options.sizing.tolerance = tolerance;
    options.seed = seed;
    Monitor monitor({});
    sampling::Resampled made =
        sampling::resample(reference, mesh, {}, options, std::nullopt, nullptr, monitor, Workers(threads));
    sampling::free_buried(made.cloud, made.complex, reference);
    return start_of(made, sampling::label_surface(made.cloud, made.complex, reference), body);
}

Start start_of(const Body &body) {
    Start start;
    start.body = body;
    start.size.assign(body.points.size(), body.size);
    return start;
}

Start pinned(const Body &body) {
    Start start = start_of(body);
    for (std::size_t v = 0; v < body.points.size(); ++v)
        if (body.stratum[v] != Stratum::interior) {
            start.body.stratum[v] = Stratum::corner;
            start.body.label[v] = -1;
        }
    return start;
}

Searched searched(const Start &start, const Body &on, double tolerance, const search::SearchOptions &options,
                  bool loose, const std::vector<double> &local) {
    Searched out;
    out.complex = search::complex_of(stratified_mesh(start.body, start.size));
    const double size =
        std::accumulate(start.size.begin(), start.size.end(), 0.0) / static_cast<double>(start.size.size());
    const std::vector<std::uint8_t> may(on.creases.size(), loose); // as many curves at most
    search::CreaseRelease search(out.complex, {on.points, on.facets, on.patch, on.creases, on.curve, may, 0.0, local},
                                 tolerance, 0.125 * size);
    out.outcome = search.run(options, [](const char *, double, int) { return true; });
    out.released = search.released();
    return out;
}

bool well_centered(const std::array<Vec3, 4> &p, bool acute) {
    return geometry::contains_circumcenter(p[0], p[1], p[2], p[3]) &&
           (!acute || std::all_of(std::begin(kFacets), std::end(kFacets),
                                  [&](const auto &f) { return geometry::acute(p[f[0]], p[f[1]], p[f[2]]); }));
}

int not_well_centered(const search::TetComplex &complex, bool acute) {
    int count = 0;
    for (std::size_t k = 0; k < complex.tet_slots(); ++k) {
        const int t = static_cast<int>(k);
        if (!complex.alive(t))
            continue;
        std::array<Vec3, 4> p;
        for (int i = 0; i < 4; ++i)
            p[i] = complex.point(complex.tet(t)[i]);
        count += !well_centered(p, acute);
    }
    return count;
}

} // namespace wct::tests
