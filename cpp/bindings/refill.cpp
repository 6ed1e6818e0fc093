#include "bindings/bindings.h"
#include "bindings/domain.h"
#include "bindings/workers.h"

#include "conform/conform_inside.h"
#include "refill/refill.h"

#include <nanobind/stl/optional.h>

#include <limits>
#include <optional>
#include <stdexcept>

namespace nb = nanobind;

namespace wct::bindings {

namespace {

nb::dict to_python(const refill::Refilled &interior) {
    nb::dict out;
    out["points"] = array_of(interior.points);
    out["tets"] = array_of<std::int64_t>(interior.tets);
    out["regions"] = array_of<std::int64_t>(interior.region);
    out["origin"] = array_of<std::int64_t>(interior.origin);
    out["size"] = array_of<double>(interior.size);
    out["stopped"] = interior.stopped;
    return out;
}

/// A mesh and what of its surface has to stay.
struct Pinned {
    Pinned(const Array &points, const Array &tets, const Array &region, const Array &pinned, const Array &facets,
           const Array &facet_patch, const Array &sides, const Array &kept)
        : mesh(mesh_of(points, tets, region)),
          surface(surface_of(mesh.points, facets, "facets", facet_patch, "facet_patch", sides)),
          edges(cells_of<2>(kept, mesh.points.size(), "edges")), stay(mesh.points.size(), 0) {
        for (const int v : numbers_of(pinned, static_cast<std::int64_t>(mesh.points.size()), "pinned"))
            stay[v] = 1;
        if (surface.triangles.empty() || mesh.tets.empty())
            throw std::invalid_argument("facets and tets are needed");
    }

    domain::InputMesh mesh;
    domain::SurfaceData surface;
    std::vector<Edge> edges;
    std::vector<char> stay;
};

nb::dict refill_arrays(const Array &points, const Array &tets, const Array &region, const Array &pinned,
                       const Array &facets, const Array &facet_patch, const Array &sides, const Array &edges,
                       const std::optional<Array> &size, bool cosines, std::uint64_t seed, const nb::object &progress,
                       unsigned threads) {
    const Pinned given(points, tets, region, pinned, facets, facet_patch, sides, edges);
    const std::vector<double> wanted = wanted_of(size, given.mesh);
    refill::RefillOptions options;
    options.cosines = cosines;
    options.seed = seed;
    if (size) { // what is asked for is not to be adapted
        options.size = 1.0;
        options.seeds.edge_per_cell = sampling::SeedForm{}.edge_per_cell;
        options.most = std::numeric_limits<double>::infinity();
    }
    Monitor::Listener listener = [&](double done, std::int64_t bad) { return goes_on(progress, done, bad); };
    refill::Refilled interior;
    {
        nb::gil_scoped_release release;
        Monitor monitor(listener);
        interior = refill::refill(domain::Reference(given.surface), given.mesh, given.stay, given.edges, wanted,
                                  options, monitor, workers_of(threads));
    }
    return to_python(interior);
}

nb::dict conform_inside_arrays(const Array &points, const Array &tets, const Array &region, const Array &pinned,
                               const Array &facets, const Array &facet_patch, const Array &sides, const Array &edges,
                               const Array &size, bool one_sided, int effort, std::uint64_t seed,
                               const nb::object &progress) {
    const Pinned given(points, tets, region, pinned, facets, facet_patch, sides, edges);
    const std::vector<double> sizes = sizes_of(size, given.mesh.points.size(), "size");
    conform::ConformOptions options;
    options.one_sided = one_sided;
    options.effort = effort;
    options.seed = seed;
    Monitor::Listener listener = [&](double done, std::int64_t bad) { return goes_on(progress, done, bad); };
    refill::Refilled interior;
    {
        nb::gil_scoped_release release;
        Monitor monitor(listener);
        interior = conform::conform_inside(domain::Reference(given.surface), given.mesh, given.stay, given.edges, sizes,
                                           options, monitor);
    }
    return to_python(interior);
}

} // namespace

void bind_refill(nb::module_ &m) {
    m.def(
        "refill", &refill_arrays, nb::arg("points"), nb::arg("tets"), nb::arg("region"), nb::arg("pinned"),
        nb::arg("facets"), nb::arg("facet_patch"), nb::arg("sides"), nb::arg("edges"), nb::kw_only(),
        nb::arg("size") = nb::none(), nb::arg("cosines") = true, nb::arg("seed") = 1, nb::arg("progress") = nb::none(),
        nb::arg("threads") = 0,
        "Fill a mesh anew between its surface facets, which stay: points, tets, region per tet >= 0; pinned points,\n"
        "facets (f, 3) with their patch (f,), sides (patches, 2) as in resample, edges (e, 2) that stay. size: wanted\n"
        "edge length per point; without it the new mesh has up to twice the tets. progress(done, bad) returns False\n"
        "to stop.\n\n"
        "Returns a dict: points, origin (the input's point, -1 for a new one), size (edge length wanted), tets,\n"
        "regions, stopped. No tets where the facets leave no choice, or where it was stopped early.");
    m.def("conform_inside", &conform_inside_arrays, nb::arg("points"), nb::arg("tets"), nb::arg("region"),
          nb::arg("pinned"), nb::arg("facets"), nb::arg("facet_patch"), nb::arg("sides"), nb::arg("edges"),
          nb::arg("size"), nb::kw_only(), nb::arg("one_sided") = true, nb::arg("effort") = 1, nb::arg("seed") = 1,
          nb::arg("progress") = nb::none(),
          "Make a mesh Delaunay, and one-sided, between its surface facets, which stay: arguments and result as of\n"
          "refill; size: edge length per point.");
}

} // namespace wct::bindings
