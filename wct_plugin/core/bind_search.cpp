#include "bindings.h"
#include "search.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/function.h>

namespace nb = nanobind;

namespace wct {

namespace {

using Reals = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using RealRow = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Indices = nb::ndarray<const std::int64_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using IndexRow = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Bytes = nb::ndarray<const std::int8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

std::vector<Vec3> points_of(const Reals &rows) {
    std::vector<Vec3> out(rows.shape(0));
    for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = {rows(i, 0), rows(i, 1), rows(i, 2)};
    return out;
}

template <std::size_t n> std::vector<std::array<int, n>> cells_of(const Indices &rows) {
    std::vector<std::array<int, n>> out(rows.shape(0));
    for (std::size_t i = 0; i < out.size(); ++i)
        for (std::size_t k = 0; k < n; ++k)
            out[i][k] = static_cast<int>(rows(i, k));
    return out;
}

std::vector<int> labels_of(const IndexRow &row) {
    std::vector<int> out(row.shape(0));
    for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = static_cast<int>(row(i));
    return out;
}

template <class T> nb::object array_of(std::vector<T> values, std::size_t columns) {
    auto *kept = new std::vector<T>(std::move(values));
    nb::capsule owner(kept, [](void *p) noexcept { delete static_cast<std::vector<T> *>(p); });
    if (columns == 0) {
        const std::size_t shape[1] = {kept->size()};
        return nb::cast(nb::ndarray<nb::numpy, T>(kept->data(), 1, shape, owner));
    }
    const std::size_t shape[2] = {kept->size() / columns, columns};
    return nb::cast(nb::ndarray<nb::numpy, T>(kept->data(), 2, shape, owner));
}

nb::dict search_well_centered(const Reals &points, const Indices &tets, const IndexRow &regions, const Bytes &stratum,
                              const IndexRow &label, const RealRow &size, const Indices &facets,
                              const IndexRow &facet_patch, const Indices &creases, const IndexRow &crease_curve,
                              const Reals &surface_points, const Indices &surface_triangles,
                              const IndexRow &surface_patch, const Indices &surface_segments,
                              const IndexRow &surface_curve, double tolerance, double shell, bool acute, double margin, bool flip_surface,
                              bool split_surface,
                              int passes, long kicks, std::uint64_t seed, nb::object progress) {
    TetComplex complex;
    SurfaceGuide guide(points_of(surface_points), cells_of<3>(surface_triangles), labels_of(surface_patch),
                       cells_of<2>(surface_segments), labels_of(surface_curve), tolerance, shell);
    const std::vector<Vec3> given = points_of(points);
    for (std::size_t v = 0; v < given.size(); ++v)
        complex.add_vertex({given[v], static_cast<Stratum>(stratum(v)), static_cast<int>(label(v)), size(v), given[v]});
    const auto cells = cells_of<4>(tets);
    for (std::size_t t = 0; t < cells.size(); ++t)
        complex.add_tet(cells[t], static_cast<int>(regions(t)), 0.0);
    const auto triangles = cells_of<3>(facets);
    for (std::size_t k = 0; k < triangles.size(); ++k)
        complex.add_facet(sorted(triangles[k][0], triangles[k][1], triangles[k][2]), static_cast<int>(facet_patch(k)));
    const auto segments = cells_of<2>(creases);
    for (std::size_t k = 0; k < segments.size(); ++k)
        complex.add_crease(sorted(segments[k][0], segments[k][1]), static_cast<int>(crease_curve(k)));

    SearchOptions options;
    options.acute = acute;
    options.margin = margin;
    options.flip_surface = flip_surface;
    options.split_surface = split_surface;
    options.passes = passes;
    options.kicks = kicks;
    options.seed = seed;
    SearchOutcome outcome;
    {
        nb::gil_scoped_release release;
        Search search(complex, guide, options);
        outcome = search.run([&](const char *phase, double done, int bad) {
            nb::gil_scoped_acquire acquire;
            if (PyErr_CheckSignals() != 0)
                throw nb::python_error();
            return progress.is_none() || nb::cast<bool>(progress(phase, done, bad));
        });
    }
    std::vector<int> place(complex.vertex_slots(), -1);
    std::vector<double> out_points;
    std::vector<std::int64_t> out_tets, out_regions, out_labels, out_facets, out_patches, out_creases, out_curves;
    std::vector<std::int8_t> out_strata;
    for (std::size_t k = 0; k < complex.vertex_slots(); ++k) {
        const int v = static_cast<int>(k);
        if (!complex.used(v))
            continue;
        place[v] = static_cast<int>(out_strata.size());
        const Vertex &vertex = complex.vertex(v);
        out_points.insert(out_points.end(), {vertex.position.x, vertex.position.y, vertex.position.z});
        out_strata.push_back(static_cast<std::int8_t>(vertex.stratum));
        out_labels.push_back(vertex.label);
    }
    for (std::size_t k = 0; k < complex.tet_slots(); ++k) {
        const int t = static_cast<int>(k);
        if (!complex.alive(t))
            continue;
        for (int v : complex.tet(t))
            out_tets.push_back(place[v]);
        out_regions.push_back(complex.region(t));
    }
    std::vector<std::pair<Facet, int>> surface;
    for (const auto &[key, facet] : complex.surface())
        surface.push_back({key, facet.patch});
    std::sort(surface.begin(), surface.end());
    for (const auto &[key, patch] : surface) {
        for (int v : key)
            out_facets.push_back(place[v]);
        out_patches.push_back(patch);
    }
    std::vector<std::pair<Edge, int>> curves(complex.creases().begin(), complex.creases().end());
    std::sort(curves.begin(), curves.end());
    for (const auto &[key, curve] : curves) {
        for (int v : key)
            out_creases.push_back(place[v]);
        out_curves.push_back(curve);
    }
    nb::dict result;
    result["points"] = array_of(std::move(out_points), 3);
    result["tets"] = array_of(std::move(out_tets), 4);
    result["regions"] = array_of(std::move(out_regions), 0);
    result["stratum"] = array_of(std::move(out_strata), 0);
    result["label"] = array_of(std::move(out_labels), 0);
    result["facets"] = array_of(std::move(out_facets), 3);
    result["facet_patch"] = array_of(std::move(out_patches), 0);
    result["creases"] = array_of(std::move(out_creases), 2);
    result["crease_curve"] = array_of(std::move(out_curves), 0);
    result["bad"] = outcome.bad;
    result["passes"] = outcome.passes;
    result["kicks"] = outcome.kicks;
    result["accepted"] = outcome.accepted;
    result["evaluations"] = outcome.evaluations;
    result["stopped"] = outcome.stopped;
    return result;
}

} // namespace

void bind_search(nb::module_ &m) {
    m.def("search_well_centered", &search_well_centered, nb::arg("points"), nb::arg("tets"), nb::arg("regions"),
          nb::arg("stratum"), nb::arg("label"), nb::arg("size"), nb::arg("facets"), nb::arg("facet_patch"),
          nb::arg("creases"), nb::arg("crease_curve"), nb::arg("surface_points"), nb::arg("surface_triangles"),
          nb::arg("surface_patch"), nb::arg("surface_segments"), nb::arg("surface_curve"), nb::kw_only(),
          nb::arg("tolerance"), nb::arg("shell"), nb::arg("acute"), nb::arg("margin"),
          nb::arg("flip_surface"), nb::arg("split_surface"), nb::arg("passes"),
          nb::arg("kicks"), nb::arg("seed"), nb::arg("progress").none());
}

} // namespace wct
