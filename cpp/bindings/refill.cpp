#include "bindings/bindings.h"
#include "bindings/conform_options.h"
#include "bindings/domain.h"
#include "bindings/workers.h"

#include "conform/conform_inside.h"
#include "refill/refill.h"

#include <nanobind/stl/optional.h>

#include <array>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace nb = nanobind;

namespace wct::bindings {

namespace {

nb::object to_python(const refill::Refilled &interior) {
    nb::dict out;
    out["points"] = array_of(interior.points);
    out["tets"] = array_of<std::int64_t>(interior.tets);
    out["regions"] = array_of<std::int64_t>(interior.region);
    out["origin"] = array_of<std::int64_t>(interior.origin);
    out["size"] = array_of<double>(interior.size);
    out["stopped"] = interior.stopped;
    return made("wct_plugin.core.results", "RefillResult", out);
}

/// A mesh, and its surface, which has to stay.
struct Pinned {
    Pinned(nb::handle of, const Array &sides) : Pinned(of, sides_of(sides)) {}

    Pinned(nb::handle of, const std::vector<std::array<int, 2>> &sides) {
        search::StratifiedMesh given = mesh_with_surface(of, sides);
        surface = surface_of_facets(given, sides);
        for (const Stratum stratum : given.stratum)
            stay.push_back(stratum != Stratum::interior);
        edges = std::move(given.creases);
        sizes = std::move(given.size);
        mesh = {std::move(given.points), std::move(given.tets), std::move(given.region)};
    }

    domain::InputMesh mesh;
    domain::SurfaceData surface;
    std::vector<Edge> edges;
    std::vector<char> stay;
    std::vector<double> sizes;
};

nb::object refill(nb::handle mesh, const Array &sides, const std::optional<Array> &size, bool cosines,
                  std::uint64_t seed, const nb::object &progress, const nb::object &expected, unsigned threads) {
    const Pinned given(mesh, sides);
    const std::vector<double> wanted = wanted_of(size, given.mesh);
    refill::RefillOptions options;
    options.cosines = cosines;
    options.seed = seed;
    if (size) { // what is asked for is not to be adapted
        options.size = 1.0;
        options.seeds.edge_per_cell = sampling::SeedForm{}.edge_per_cell;
        options.most = std::numeric_limits<double>::infinity();
    }
    if (size && !expected.is_none()) // else there are no more than so many
        options.expected = [&](double tets) { return goes_on(expected, tets); };
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

nb::object conform_inside(nb::handle mesh, const Array &sides, nb::handle asked, const nb::object &progress) {
    const Pinned given(mesh, sides);
    const conform::ConformOptions options = conform_options_of(asked);
    Monitor::Listener listener = [&](double done, std::int64_t bad) { return goes_on(progress, done, bad); };
    refill::Refilled interior;
    {
        nb::gil_scoped_release release;
        Monitor monitor(listener);
        interior = conform::conform_inside(domain::Reference(given.surface), given.mesh, given.stay, given.edges,
                                           given.sizes, options, monitor);
    }
    return to_python(interior);
}

} // namespace

void bind_refill(nb::module_ &m) {
    m.def("refill", &refill, nb::arg("mesh"), nb::arg("sides"), nb::kw_only(), nb::arg("size") = nb::none(),
          nb::arg("cosines") = true, nb::arg("seed") = 1, nb::arg("progress") = nb::none(),
          nb::arg("expected") = nb::none(), nb::arg("threads") = 0,
          nb::sig("def refill(mesh: wct_plugin.core.domain.StratifiedMesh,"
                  " sides: numpy.typing.NDArray[numpy.int64], *,"
                  " size: numpy.typing.NDArray[numpy.float64] | None = None, cosines: bool = True, seed: int = 1,"
                  " progress: collections.abc.Callable[[float, int], typing.Any] | None = None,"
                  " expected: collections.abc.Callable[[float], typing.Any] | None = None,"
                  " threads: int = 0) -> wct_plugin.core.results.RefillResult"),
          R"(Fill a mesh anew between its surface facets, which stay, as do its creases and all points of its surface.

Parameters
----------
mesh
    With its surface; its sizes do not matter.
sides
    (patches, 2) of its patches, as of a StratifiedSurface.
size
    (n,) wanted edge length per point; without it the new mesh has up to twice the tets.
cosines
    Triangles are to be acute, too.
expected
    As of resample; it is called where there are wanted lengths.
seed, progress, threads
    As of resample.

Returns
-------
RefillResult
    The same input and seed give the same bits.

Raises
------
ValueError
    Where an array has a wrong type, shape or index.)");
    m.def("conform_inside", &conform_inside, nb::arg("mesh"), nb::arg("sides"), nb::arg("options"),
          nb::arg("progress") = nb::none(),
          nb::sig("def conform_inside(mesh: wct_plugin.core.domain.StratifiedMesh,"
                  " sides: numpy.typing.NDArray[numpy.int64], options: wct_plugin.core.requests.ConformOptions,"
                  " progress: collections.abc.Callable[[float, int], typing.Any] | None = None)"
                  " -> wct_plugin.core.results.RefillResult"),
          R"(Make a mesh Delaunay, and one-sided, between its surface facets, which stay.

Arguments, result and errors as of refill; edges are as long as the mesh's sizes say.)");
}

} // namespace wct::bindings
