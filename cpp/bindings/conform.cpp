#include "bindings/bindings.h"
#include "bindings/domain.h"
#include "bindings/workers.h"

#include "bindings/conform_options.h"
#include "conform/conform.h"

#include <array>
#include <optional>
#include <stdexcept>
#include <utility>

namespace nb = nanobind;

namespace wct::bindings {

namespace {

nb::object to_python(const conform::Conformed &found) {
    search::StratifiedMesh mesh{
        found.points,         found.role,          found.label,           found.size,         found.tets, found.region,
        found.surface.facets, found.surface.patch, found.surface.creases, found.surface.curve};
    for (std::size_t i = 0; i < mesh.label.size(); ++i) // a corner's is its own point, an inner point's its region
        if (mesh.stratum[i] != Stratum::patch && mesh.stratum[i] != Stratum::crease)
            mesh.label[i] = -1;
    nb::dict faults;
    faults["creases"] = found.faults.creases;
    faults["surface"] = found.faults.surface;
    faults["off"] = found.faults.off;
    faults["outer"] = found.faults.outer;
    faults["edges"] = found.faults.edges;
    faults["ties"] = found.faults.ties;
    nb::dict out;
    out["mesh"] = object_of(mesh);
    out["origin"] = array_of<std::int64_t>(found.origin);
    out["rounds"] = found.rounds;
    out["intact"] = found.intact;
    out["faults"] = faults;
    out["stopped"] = found.stopped;
    return made("wct_plugin.core.results", "ConformResult", out);
}

nb::object conform(nb::handle of, const Array &sides, double tolerance, nb::handle asked, nb::handle given,
                   const nb::object &progress, unsigned threads) {
    std::vector<std::array<int, 2>> around = sides_of(sides);
    search::StratifiedMesh from = mesh_with_surface(of, around);
    conform::ConformOptions options = conform_options_of(asked);
    options.tolerance = tolerance;
    options.stays = listed(asked, "stays", around.size());
    domain::SurfaceData surface = surface_of_facets(from, std::move(around));
    surface.segments = from.creases;
    surface.curve = from.crease_curve;
    if (!(tolerance > 0.0))
        throw std::invalid_argument("tolerance must be positive");
    for (std::size_t v = 0; v < from.stratum.size(); ++v)
        if (from.stratum[v] == Stratum::corner)
            surface.corners.push_back(static_cast<int>(v));
    const domain::InputMesh mesh{std::move(from.points), std::move(from.tets), std::move(from.region)};
    domain::SurfaceData other;
    if (!given.is_none())
        other = plain_surface_of(given);
    Monitor::Listener listener = [&](double done, std::int64_t bad) { return goes_on(progress, done, bad); };
    conform::Conformed found;
    {
        nb::gil_scoped_release release;
        Monitor monitor(listener);
        const domain::Reference reference(std::move(surface));
        std::optional<domain::Reference> stands_for;
        if (!other.triangles.empty())
            stands_for.emplace(std::move(other));
        found = conform::conform(reference, stands_for, mesh, from.stratum, from.label, from.size, options, monitor,
                                 workers_of(threads));
    }
    return to_python(found);
}

} // namespace

void bind_conform(nb::module_ &m) {
    m.def(
        "conform", &conform, nb::arg("mesh"), nb::arg("sides"), nb::arg("tolerance"), nb::arg("options"), nb::kw_only(),
        nb::arg("given") = nb::none(), nb::arg("progress") = nb::none(), nb::arg("threads") = 0,
        nb::sig("def conform(mesh: wct_plugin.core.domain.StratifiedMesh,"
                " sides: numpy.typing.NDArray[numpy.int64], tolerance: float,"
                " options: wct_plugin.core.requests.ConformOptions, *,"
                " given: wct_plugin.core.domain.Triangles | None = None,"
                " progress: collections.abc.Callable[[float, int], typing.Any] | None = None,"
                " threads: int = 0) -> wct_plugin.core.results.ConformResult"),
        R"(Make a mesh Delaunay, and one-sided, with its surface vertices where they are, or nearly so within their planes.

Parameters
----------
mesh
    With its surface.
sides
    (patches, 2) of its patches, as of a StratifiedSurface.
tolerance
    Greatest distance, a length, of the new surface from the facets, or from the given triangles where there are some.
options
    How.
given
    Triangles that the facets stand for.
progress, threads
    As of resample.

Returns
-------
ConformResult
    The same input and seed give the same bits.

Raises
------
ValueError
    Where an array has a wrong type, shape or index, or an option a value that is not allowed.)");
}

} // namespace wct::bindings
