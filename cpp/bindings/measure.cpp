#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "bindings/workers.h"
#include "measure/circumcentric_dual.h"
#include "measure/tet_shapes.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

namespace nb = nanobind;

namespace wct::bindings {

namespace {

struct Mesh {
    std::vector<Vec3> points;
    std::vector<Tet> tets;

    Mesh(const Array &given_points, const Array &given_tets)
        : points(points_of(given_points)), tets(cells_of<4>(given_tets, points.size(), "tets")) {}
};

nb::tuple measure_arrays(const Array &points, const Array &tets, unsigned threads) {
    const Mesh mesh(points, tets);
    const std::size_t count = mesh.tets.size();
    auto floats = std::make_unique<double[]>(8 * count);
    auto worst = std::make_unique<std::int8_t[]>(count);
    auto flags = std::make_unique<bool[]>(3 * count);
    {
        nb::gil_scoped_release release;
        const auto row = [&](std::size_t k) { return std::span(floats.get() + k * count, count); };
        const auto flag = [&](std::size_t k) { return std::span(flags.get() + k * count, count); };
        measure::measure(mesh.points, mesh.tets,
                         {row(0),
                          row(1),
                          row(2),
                          row(3),
                          row(4),
                          row(5),
                          row(6),
                          row(7),
                          {worst.get(), count},
                          flag(0),
                          flag(1),
                          flag(2)},
                         workers_of(threads));
    }
    return nb::make_tuple(fresh(std::move(floats), 8, count), fresh(std::move(worst), count),
                          fresh(std::move(flags), 3, count));
}

/// One number per tet.
using PerTet = void (*)(const std::vector<Vec3> &, const std::vector<Tet> &, std::span<double>, const Workers &);

template <PerTet of> nb::object per_tet(const Array &points, const Array &tets, unsigned threads) {
    const Mesh mesh(points, tets);
    return array<double>(mesh.tets.size(), 0, [&](double *to) {
        nb::gil_scoped_release release;
        of(mesh.points, mesh.tets, {to, mesh.tets.size()}, workers_of(threads));
    });
}

nb::tuple height_arrays(const Array &points, const Array &tets, unsigned threads) {
    const Mesh mesh(points, tets);
    const std::size_t count = mesh.tets.size();
    auto values = std::make_unique<double[]>(4 * count);
    auto errors = std::make_unique<double[]>(4 * count);
    {
        nb::gil_scoped_release release;
        measure::heights(mesh.points, mesh.tets, {values.get(), 4 * count}, {errors.get(), 4 * count},
                         workers_of(threads));
    }
    return nb::make_tuple(fresh(std::move(values), count, 4), fresh(std::move(errors), count, 4));
}

nb::tuple edge_sum_arrays(const Array &points, const Array &tets, const Array &tet_edges, std::size_t edges,
                          const std::optional<Array> &coefficient, unsigned threads) {
    const Mesh mesh(points, tets);
    const auto edges_of = cells_of<6>(tet_edges, edges, "tet_edges");
    expect_length(edges_of.size(), mesh.tets.size(), "tet_edges");
    std::span<const double> factors;
    if (coefficient) {
        factors = rows<double>(*coefficient, 0, "coefficient");
        expect_length(factors.size(), mesh.tets.size(), "coefficient");
    }
    const std::size_t count = mesh.tets.size();
    auto values = std::make_unique<double[]>(4 * count);
    auto errors = std::make_unique<double[]>(4 * count);
    auto sums = std::make_unique<double[]>(edges);
    auto doubts = std::make_unique<double[]>(edges);
    {
        nb::gil_scoped_release release;
        measure::edge_sums(mesh.points, mesh.tets, edges_of, factors, {values.get(), 4 * count},
                           {errors.get(), 4 * count}, {sums.get(), edges}, {doubts.get(), edges}, workers_of(threads));
    }
    return nb::make_tuple(fresh(std::move(values), count, 4), fresh(std::move(errors), count, 4),
                          fresh(std::move(sums), edges), fresh(std::move(doubts), edges));
}

nb::object orthogonality_array(const Array &points, const Array &tets, const Array &pairs, unsigned threads) {
    const Mesh mesh(points, tets);
    const auto across = cells_of<4>(pairs, std::max<std::size_t>(mesh.tets.size(), 4), "pairs");
    for (const auto &[tet, facet, other, its] : across)
        if (std::max(tet, other) >= static_cast<std::int32_t>(mesh.tets.size()) || std::max(facet, its) > 3)
            refuse("pairs name a tet or a facet that there is not");
    return array<double>(across.size(), 0, [&](double *to) {
        nb::gil_scoped_release release;
        measure::orthogonality(mesh.points, mesh.tets, across, {to, across.size()}, workers_of(threads));
    });
}

nb::object dihedral_count_array(const Array &points, const Array &tets, const Array &bins, unsigned threads) {
    const Mesh mesh(points, tets);
    const auto edges = rows<double>(bins, 0, "bins");
    if (edges.size() < 2 || !std::is_sorted(edges.begin(), edges.end()))
        throw std::invalid_argument("bins must be two numbers or more that ascend");
    std::vector<std::int64_t> counts;
    {
        nb::gil_scoped_release release;
        counts = measure::dihedral_counts(mesh.points, mesh.tets, edges, workers_of(threads));
    }
    return array_of<std::int64_t>(counts);
}

} // namespace

void bind_measure(nb::module_ &m) {
#define WCT_MESH "points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64]"
#define WCT_FLOATS "numpy.typing.NDArray[numpy.float64]"
    m.def("measure_tets", &measure_arrays, nb::arg("points"), nb::arg("tets"), nb::arg("threads") = 0,
          nb::sig("def measure_tets(" WCT_MESH ", threads: int = 0) -> tuple[" WCT_FLOATS
                  ", numpy.typing.NDArray[numpy.int8], numpy.typing.NDArray[numpy.bool_]]"),
          R"(Measures of ``tets`` (m, 4): numbers (8, m), the facet (m,) with the smallest h/R, flags (3, m).

The numbers are the smallest and largest h/R, face angle and dihedral angle in degrees, circumradius over shortest edge,
and signed volume; the flags, exact, are 3WC, 2WC and acute.)");
    m.def("tet_volumes", &per_tet<&measure::volumes>, nb::arg("points"), nb::arg("tets"), nb::arg("threads") = 0,
          nb::sig("def tet_volumes(" WCT_MESH ", threads: int = 0) -> " WCT_FLOATS),
          R"(Signed volumes (m,) of ``tets`` (m, 4).)");
    m.def("circumradii", &per_tet<&measure::circumradii>, nb::arg("points"), nb::arg("tets"), nb::arg("threads") = 0,
          nb::sig("def circumradii(" WCT_MESH ", threads: int = 0) -> " WCT_FLOATS),
          R"(Circumradii (m,) of ``tets`` (m, 4).)");
    m.def("unsigned_volumes", &per_tet<&measure::unsigned_volumes>, nb::arg("points"), nb::arg("tets"),
          nb::arg("threads") = 0, nb::sig("def unsigned_volumes(" WCT_MESH ", threads: int = 0) -> " WCT_FLOATS),
          R"(Volume (m,) of the parts of dual cells in each of ``tets`` (m, 4), without their signs.

Infinite in tets so flat that it is not known.)");
    m.def("circumcenter_heights", &height_arrays, nb::arg("points"), nb::arg("tets"), nb::arg("threads") = 0,
          nb::sig("def circumcenter_heights(" WCT_MESH ", threads: int = 0) -> tuple[" WCT_FLOATS ", " WCT_FLOATS "]"),
          R"(Signed heights (m, 4) of circumcenters over the facets opposite each corner of ``tets`` (m, 4).

And bounds of their rounding errors (m, 4), infinite where nothing is known.)");
    m.def(
        "dual_edge_sums", &edge_sum_arrays, nb::arg("points"), nb::arg("tets"), nb::arg("tet_edges"), nb::arg("edges"),
        nb::arg("coefficient").none() = nb::none(), nb::arg("threads") = 0,
        nb::sig("def dual_edge_sums(" WCT_MESH ", tet_edges: numpy.typing.NDArray[numpy.int64], edges: int, "
                "coefficient: " WCT_FLOATS " | None = None, threads: int = 0) -> tuple[" WCT_FLOATS ", " WCT_FLOATS
                ", " WCT_FLOATS ", " WCT_FLOATS "]"),
        R"(What :func:`circumcenter_heights` gives, and per edge (edges,) the sum of cot(gamma) h, and its error's bound.

The sum runs over the facets at the edge in each of ``tets`` (m, 4), gamma the facet's angle opposite the edge, h the
circumcenter's height over the facet. ``tet_edges`` (m, 6) are the numbers of the tets' edges, ``coefficient`` (m,)
multiplies all that is of a tet.)");
    m.def("orthogonality", &orthogonality_array, nb::arg("points"), nb::arg("tets"), nb::arg("pairs"),
          nb::arg("threads") = 0,
          nb::sig("def orthogonality(" WCT_MESH
                  ", pairs: numpy.typing.NDArray[numpy.int64], threads: int = 0) -> " WCT_FLOATS),
          R"(Cosine (p,) between a facet's normal and the line between its tets' centroids.

A row of ``pairs`` (p, 4) is a tet, its facet, the tet across, its facet.)");
    m.def("dihedral_counts", &dihedral_count_array, nb::arg("points"), nb::arg("tets"), nb::arg("bins"),
          nb::arg("threads") = 0,
          nb::sig("def dihedral_counts(" WCT_MESH ", bins: " WCT_FLOATS ", threads: int = 0) -> "
                  "numpy.typing.NDArray[numpy.int64]"),
          R"(How many of the dihedral angles of ``tets`` (m, 4), in degrees, are in each of the bins (b + 1 ends).)");
#undef WCT_MESH
#undef WCT_FLOATS
}

} // namespace wct::bindings
