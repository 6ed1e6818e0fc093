#include "bind_arrays.h"
#include "bindings.h"

#include "interior.h"

#include <nanobind/stl/optional.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>

namespace nb = nanobind;

namespace wct {

namespace {

template <class T> nb::object list_of(const std::vector<int> &values) {
    return array<T>(values.size(), 0, [&](T *to) { std::copy(values.begin(), values.end(), to); });
}

nb::dict to_python(const Interior &interior) {
    nb::dict out;
    out["points"] = array<double>(interior.points.size(), 3, [&](double *to) {
        for (const Vec3 &p : interior.points) {
            *to++ = p.x;
            *to++ = p.y;
            *to++ = p.z;
        }
    });
    out["tets"] = array<std::int64_t>(interior.tets.size(), 4, [&](std::int64_t *to) {
        for (const Tet &tet : interior.tets)
            to = std::copy(tet.begin(), tet.end(), to);
    });
    out["regions"] = list_of<std::int64_t>(interior.region);
    out["origin"] = list_of<std::int64_t>(interior.origin);
    out["size"] = array<double>(interior.size.size(), 0,
                                [&](double *to) { std::copy(interior.size.begin(), interior.size.end(), to); });
    out["stopped"] = interior.stopped;
    return out;
}

nb::dict refill_arrays(const Array &points, const Array &tets, const Array &region, const Array &pinned,
                       const Array &facets, const Array &facet_patch, const Array &sides, const Array &edges,
                       const std::optional<Array> &size, bool cosines, std::uint64_t seed, const nb::object &progress) {
    InputMesh mesh;
    mesh.points = points_of(points);
    mesh.tets = cells_of<4>(tets, mesh.points.size(), "tets");
    mesh.region = numbers_of(region, mesh.tets.size(), std::int64_t{1} << 30, "region");
    SurfaceData surface;
    surface.points = mesh.points;
    surface.triangles = cells_of<3>(facets, mesh.points.size(), "facets");
    const auto of_sides = rows<std::int64_t>(sides, 2, "sides");
    for (std::size_t i = 0; i < of_sides.size(); i += 2)
        surface.sides.push_back({static_cast<int>(of_sides[i]), static_cast<int>(of_sides[i + 1])});
    surface.patch = numbers_of(facet_patch, surface.triangles.size(), static_cast<std::int64_t>(surface.sides.size()),
                               "facet_patch");
    const auto held = cells_of<2>(edges, mesh.points.size(), "edges");
    std::vector<char> stay(mesh.points.size(), 0);
    for (const int v : numbers_of(pinned, rows<std::int64_t>(pinned, 0, "pinned").size(),
                                  static_cast<std::int64_t>(mesh.points.size()), "pinned"))
        stay[v] = 1;
    if (surface.triangles.empty() || mesh.tets.empty())
        throw std::invalid_argument("facets and tets are needed");
    std::vector<double> wanted;
    if (size)
        wanted = sizes_of(*size, mesh.points.size(), "size");
    InteriorForm form;
    form.cosines = cosines;
    form.seed = seed;
    if (size) { // what is asked for is not to be adapted
        form.size = 1.0;
        form.seeds = SeedForm{};
        form.most = std::numeric_limits<double>::infinity();
    }
    Monitor::Listener listener = [&](double done, std::int64_t bad) { return goes_on(progress, done, bad); };
    Interior interior;
    {
        nb::gil_scoped_release release;
        Monitor monitor(listener);
        const Reference reference(std::move(surface));
        interior = refill(reference, mesh, stay, held, wanted, form, monitor);
    }
    return to_python(interior);
}

} // namespace

void bind_interior(nb::module_ &m) {
    m.def(
        "refill", &refill_arrays, nb::arg("points"), nb::arg("tets"), nb::arg("region"), nb::arg("pinned"),
        nb::arg("facets"), nb::arg("facet_patch"), nb::arg("sides"), nb::arg("edges"), nb::kw_only(),
        nb::arg("size") = nb::none(), nb::arg("cosines") = true, nb::arg("seed") = 1, nb::arg("progress") = nb::none(),
        "Fill a mesh anew between its surface facets, which stay: points, tets, region per tet >= 0; pinned points,\n"
        "facets (f, 3) with their patch (f,), sides (patches, 2) as in resample, edges (e, 2) that stay. size: wanted\n"
        "edge length per point; without it the new mesh has up to twice the tets. progress(done, bad) returns False\n"
        "to stop.\n\n"
        "Returns a dict: points, origin (the input's point, -1 for a new one), size (edge length wanted), tets,\n"
        "regions, stopped. No tets where the facets leave no choice, or where it was stopped early.");
}

} // namespace wct
