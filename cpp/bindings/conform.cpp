#include "bindings/bindings.h"
#include "bindings/domain.h"
#include "bindings/workers.h"

#include "conform/conform.h"

#include <nanobind/stl/optional.h>

#include <optional>
#include <stdexcept>

namespace nb = nanobind;

namespace wct::bindings {

namespace {

nb::dict to_python(const conform::Conformed &found) {
    nb::dict out;
    out["points"] = array_of(found.points);
    out["tets"] = array_of<std::int64_t>(found.tets);
    out["regions"] = array_of<std::int64_t>(found.region);
    out["origin"] = array_of<std::int64_t>(found.origin);
    out["stratum"] = array<std::int8_t>(found.role.size(), 0, [&](std::int8_t *to) {
        for (const Stratum role : found.role)
            *to++ = static_cast<std::int8_t>(role);
    });
    out["label"] = array<std::int64_t>(found.role.size(), 0, [&](std::int64_t *to) {
        for (std::size_t i = 0; i < found.role.size(); ++i) // a corner's is its own point, an inner point's its region
            *to++ = found.role[i] == Stratum::patch || found.role[i] == Stratum::crease ? found.label[i] : -1;
    });
    out["facets"] = array_of<std::int64_t>(found.surface.facets);
    out["facet_patch"] = array_of<std::int64_t>(found.surface.patch);
    out["creases"] = array_of<std::int64_t>(found.surface.creases);
    out["crease_curve"] = array_of<std::int64_t>(found.surface.curve);
    out["intact"] = found.intact;
    out["stopped"] = found.stopped;
    out["rounds"] = found.rounds;
    nb::dict faults;
    faults["creases"] = found.faults.creases;
    faults["surface"] = found.faults.surface;
    faults["off"] = found.faults.off;
    faults["outer"] = found.faults.outer;
    faults["edges"] = found.faults.edges;
    faults["ties"] = found.faults.ties;
    out["faults"] = faults;
    return out;
}

nb::dict conform_arrays(const Array &points, const Array &tets, const Array &region, const Array &stratum,
                        const Array &label, const Array &size, const Array &facets, const Array &facet_patch,
                        const Array &sides, const Array &creases, const Array &crease_curve, double tolerance,
                        const std::optional<Array> &given_points, const std::optional<Array> &given_triangles,
                        bool one_sided, int effort, std::uint64_t seed, const nb::object &progress, unsigned threads) {
    const domain::InputMesh mesh = mesh_of(points, tets, region);
    domain::SurfaceData surface = surface_of(mesh.points, facets, "facets", facet_patch, "facet_patch", sides);
    surface.segments = cells_of<2>(creases, mesh.points.size(), "creases");
    surface.curve = numbers_of(crease_curve, surface.segments.size(),
                               static_cast<std::int64_t>(surface.segments.size()), "crease_curve");
    if (surface.triangles.empty() || mesh.tets.empty())
        throw std::invalid_argument("facets and tets are needed");
    if (!(tolerance > 0.0))
        throw std::invalid_argument("tolerance must be positive");
    const std::vector<Stratum> role = strata_of(stratum, mesh.points.size());
    for (std::size_t v = 0; v < role.size(); ++v)
        if (role[v] == Stratum::corner)
            surface.corners.push_back(static_cast<int>(v));
    const auto of_point = labels_of(label, mesh.points.size(), "label");
    const std::vector<double> sizes = sizes_of(size, mesh.points.size(), "size");
    domain::SurfaceData other;
    if (given_points && given_triangles)
        other = plain_surface(*given_points, "given_points", *given_triangles, "given_triangles");
    conform::ConformOptions options;
    options.effort = effort;
    options.tolerance = tolerance;
    options.one_sided = one_sided;
    options.seed = seed;
    Monitor::Listener listener = [&](double done, std::int64_t bad) { return goes_on(progress, done, bad); };
    conform::Conformed found;
    {
        nb::gil_scoped_release release;
        Monitor monitor(listener);
        const domain::Reference reference(std::move(surface));
        std::optional<domain::Reference> given;
        if (!other.triangles.empty())
            given.emplace(std::move(other));
        found = conform::conform(reference, given, mesh, role, of_point, sizes, options, monitor, workers_of(threads));
    }
    return to_python(found);
}

} // namespace

void bind_conform(nb::module_ &m) {
    m.def(
        "conform", &conform_arrays, nb::arg("points"), nb::arg("tets"), nb::arg("regions"), nb::arg("stratum"),
        nb::arg("label"), nb::arg("size"), nb::arg("facets"), nb::arg("facet_patch"), nb::arg("sides"),
        nb::arg("creases"), nb::arg("crease_curve"), nb::arg("tolerance"), nb::kw_only(),
        nb::arg("given_points") = nb::none(), nb::arg("given_triangles") = nb::none(), nb::arg("one_sided") = true,
        nb::arg("effort") = 1, nb::arg("seed") = 1, nb::arg("progress") = nb::none(), nb::arg("threads") = 0,
        "Make a mesh Delaunay, and one-sided, with its surface vertices where they are: points, tets, region per tet\n"
        ">= 0, stratum, label and size per point, facets (f, 3) of the surface with their patch, sides (patches, 2)\n"
        "as in resample, creases (c, 2) with their curve. tolerance: greatest distance of the new surface from the\n"
        "facets. progress(done, bad) returns False to stop.\n\n"
        "Returns a dict: points, origin (the input's point, -1 for a new one), tets, regions, stratum, label, facets, "
        "facet_patch,\n"
        "creases, crease_curve, rounds, stopped, intact (the domain is represented) and faults: what is left, by\n"
        "kind. The same input and seed give the same bits.");
}

} // namespace wct::bindings
