#include "base/disjoint_sets.h"
#include "base/facet_uses.h"
#include "bindings/bindings.h"
#include "bindings/domain.h"
#include "bindings/workers.h"
#include "geometry/edge_table.h"
#include "geometry/euler_characteristic.h"
#include "geometry/farthest_sample.h"
#include "geometry/triangle_tree.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace nb = nanobind;

namespace wct::bindings {

namespace {

/// Nearest points of a surface: points, triangles, distances.
nb::tuple closest_arrays(const Array &surface_points, const Array &surface_triangles, const Array &queries,
                         unsigned threads) {
    const std::vector<Vec3> points = points_of(surface_points, "surface_points");
    const auto triangles = cells_of<3>(surface_triangles, points.size(), "triangles");
    if (triangles.empty())
        throw std::invalid_argument("the surface has no triangles");
    std::vector<Vec3> at = points_of(queries, "queries");
    std::vector<int> piece(at.size());
    std::vector<double> distance(at.size());
    {
        nb::gil_scoped_release release;
        const geometry::TriangleTree tree(points, triangles);
        workers_of(threads).for_chunks(at.size(), 512, [&](std::size_t first, std::size_t last) {
            int hint = -1;
            for (std::size_t i = first; i < last; ++i) {
                const auto found = tree.nearest(at[i], hint);
                at[i] = found.point;
                piece[i] = hint = found.triangle;
                distance[i] = std::sqrt(found.square);
            }
        });
    }
    return nb::make_tuple(array_of(at), array_of<std::int64_t>(piece), array_of<double>(distance));
}

/// The farthest of the samples of one surface from another: its distance and where it is.
nb::tuple farthest_arrays(const Array &sampled_points, const Array &sampled_triangles, double step,
                          const Array &surface_points, const Array &surface_triangles, unsigned threads) {
    const std::vector<Vec3> points = points_of(sampled_points, "points");
    const auto triangles = cells_of<3>(sampled_triangles, points.size(), "triangles");
    const std::vector<Vec3> on = points_of(surface_points, "surface_points");
    const auto facets = cells_of<3>(surface_triangles, on.size(), "surface_triangles");
    if (triangles.empty() || facets.empty())
        throw std::invalid_argument("the surface has no triangles");
    if (!(step >= 0.0))
        throw std::invalid_argument("step must not be negative");
    geometry::Farthest found;
    {
        nb::gil_scoped_release release;
        found =
            geometry::farthest_sample(points, triangles, step, geometry::TriangleTree(on, facets), workers_of(threads));
    }
    return nb::make_tuple(found.distance, nb::make_tuple(found.at.x, found.at.y, found.at.z));
}

/// Of each region.
nb::object euler_arrays(const Array &tets, const Array &region) {
    const auto cells = cells_of<4>(tets, std::numeric_limits<std::int32_t>::max(), "tets");
    const std::vector<int> of = numbers_of(region, cells.size(), std::int64_t{1} << 30, "region");
    std::vector<int> out;
    {
        nb::gil_scoped_release release;
        out = geometry::euler_characteristics(cells, of);
    }
    return array_of<std::int64_t>(out);
}

/// Half-facets in the order of their corners, and which have the corners of the next one.
nb::tuple facet_arrays(const Array &tets, std::size_t points) {
    const auto cells = cells_of<4>(tets, points, "tets");
    std::vector<std::int32_t> order;
    std::vector<std::uint8_t> same;
    {
        nb::gil_scoped_release release;
        order.reserve(4 * cells.size());
        same.reserve(4 * cells.size());
        FacetUses(cells, points).each([&](const Facet &, std::span<const FacetUses::Use> uses) {
            for (const FacetUses::Use &use : uses) {
                order.push_back(use.half);
                same.push_back(true);
            }
            same.back() = false;
        });
    }
    if (!same.empty())
        same.pop_back(); // the last has none after it
    return nb::make_tuple(array_of<std::int64_t>(order), array_of<bool>(same));
}

/// Half-facets that face each other, and those that face nothing; whether three or more tets share a facet.
nb::tuple facet_pair_arrays(const Array &tets, std::size_t points) {
    const auto cells = cells_of<4>(tets, points, "tets");
    std::vector<std::array<std::int32_t, 2>> pairs;
    std::vector<std::int32_t> single;
    bool crowded = false;
    {
        nb::gil_scoped_release release;
        std::vector<std::int32_t> facing(4 * cells.size(), -1);
        FacetUses(cells, points).each([&](const Facet &, std::span<const FacetUses::Use> uses) {
            crowded = crowded || uses.size() > 2;
            if (uses.size() == 2) {
                facing[uses[0].half] = uses[1].half;
                facing[uses[1].half] = uses[0].half;
            }
        });
        for (std::int32_t half = 0; half < static_cast<std::int32_t>(facing.size()); ++half)
            if (facing[half] < 0)
                single.push_back(half);
            else if (half < facing[half])
                pairs.push_back({half, facing[half]});
    }
    return nb::make_tuple(array_of<std::int64_t>(pairs), array_of<std::int64_t>(single), crowded);
}

/// Numbers of the sets that links join, in the order of their least members.
nb::object component_array(const Array &rows_of, const Array &columns, std::size_t count) {
    const auto one = rows<std::int64_t>(rows_of, 0, "rows");
    const auto other = rows<std::int64_t>(columns, 0, "columns");
    expect_length(other.size(), one.size(), "columns");
    for (const auto ends : {one, other})
        for (const std::int64_t end : ends)
            if (end < 0 || end >= static_cast<std::int64_t>(count))
                refuse("a link ends at " + std::to_string(end) + "; there are " + std::to_string(count) + " nodes");
    std::vector<int> out;
    {
        nb::gil_scoped_release release;
        DisjointSets sets(count);
        for (std::size_t k = 0; k < one.size(); ++k)
            sets.join(static_cast<int>(one[k]), static_cast<int>(other[k]));
        out = sets.numbers();
    }
    return array_of<std::int64_t>(out);
}

/// Edges, and those of each tet.
nb::tuple edge_arrays(const Array &tets, std::size_t points) {
    const auto cells = cells_of<4>(tets, points, "tets");
    geometry::EdgeTable found;
    {
        nb::gil_scoped_release release;
        found = geometry::edge_table(cells, points);
    }
    return nb::make_tuple(array_of<std::int64_t>(found.edges), array_of<std::int64_t>(found.of_tets));
}

/// Principal curvatures per triangle corner.
nb::object curvature_arrays(const Array &surface_points, const Array &triangles, const Array &patch) {
    domain::SurfaceData surface;
    surface.points = points_of(surface_points, "surface_points");
    surface.triangles = cells_of<3>(triangles, surface.points.size(), "triangles");
    const auto number = static_cast<std::int64_t>(surface.triangles.size());
    surface.patch = numbers_of(patch, surface.triangles.size(), number, "patch");
    for (const int p : surface.patch)
        surface.sides.resize(std::max<std::size_t>(surface.sides.size(), p + 1), {0, -1});
    const std::size_t count = surface.triangles.size();
    const domain::Reference reference(std::move(surface));
    return array<double>(count, 6, [&](double *to) {
        for (std::size_t t = 0; t < count; ++t)
            for (int k = 0; k < 3; ++k)
                for (const double value : reference.curvature(reference.wedge(static_cast<int>(t), k)))
                    *to++ = value;
    });
}

} // namespace

void bind_geometry(nb::module_ &m) {
    m.def("closest_points", &closest_arrays, nb::arg("surface_points"), nb::arg("triangles"), nb::arg("queries"),
          nb::arg("threads") = 0,
          nb::sig("def closest_points(surface_points: numpy.typing.NDArray[numpy.float64],"
                  " triangles: numpy.typing.NDArray[numpy.int64], queries: numpy.typing.NDArray[numpy.float64], "
                  "threads: int = 0)"
                  " -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.int64],"
                  " numpy.typing.NDArray[numpy.float64]]"),
          R"(Nearest points (q, 3) of a triangle surface, the triangles (q,) they lie on and the distances (q,).)");
    m.def(
        "edge_table", &edge_arrays, nb::arg("tets"), nb::arg("points"),
        nb::sig("def edge_table(tets: numpy.typing.NDArray[numpy.int64], points: int)"
                " -> tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int64]]"),
        R"(Every edge (e, 2) of ``tets`` (m, 4) once, ends ascending, rows in lexicographic order, and each tet's (m, 6).

The edges of a tet are those of its corners 01, 02, 03, 12, 13 and 23.)");
    m.def(
        "euler_characteristics", &euler_arrays, nb::arg("tets"), nb::arg("region"),
        nb::sig("def euler_characteristics(tets: numpy.typing.NDArray[numpy.int64], region: "
                "numpy.typing.NDArray[numpy.int64])"
                " -> numpy.typing.NDArray[numpy.int64]"),
        R"(Euler characteristic (regions,) of ``tets`` (m, 4) by ``region`` (m,): vertices - edges + facets - tets.)");
    m.def("facet_pairs", &facet_pair_arrays, nb::arg("tets"), nb::arg("points"),
          nb::sig("def facet_pairs(tets: numpy.typing.NDArray[numpy.int64], points: int)"
                  " -> tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int64], bool]"),
          R"(Half-facets, 4 times a tet of ``tets`` (m, 4) and the corner opposite, that face each other (p, 2).

The first is the smaller, and the pairs ascend by it. Then those (b,), ascending, that face nothing, and whether any
facet belongs to three tets or more; its half-facets are among the latter.)");
    m.def("components", &component_array, nb::arg("rows"), nb::arg("columns"), nb::arg("count"),
          nb::sig("def components(rows: numpy.typing.NDArray[numpy.int64], columns: numpy.typing.NDArray[numpy.int64], "
                  "count: int) -> numpy.typing.NDArray[numpy.int64]"),
          R"(Number (count,) of each node's component, where links ``rows[k]`` - ``columns[k]`` (k,) join two nodes.

Components are numbered from 0 in the order of their first nodes.)");
    m.def("facet_order", &facet_arrays, nb::arg("tets"), nb::arg("points"),
          nb::sig("def facet_order(tets: numpy.typing.NDArray[numpy.int64], points: int)"
                  " -> tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.bool_]]"),
          R"(Half-facets (4 m,), 4 times a tet of ``tets`` (m, 4) and the corner opposite, by their ascending corners.

Those with the same corners ascend. Which of them (4 m - 1,) have the same corners as the next one.)");
    m.def("farthest_sample", &farthest_arrays, nb::arg("points"), nb::arg("triangles"), nb::arg("step"),
          nb::arg("surface_points"), nb::arg("surface_triangles"), nb::arg("threads") = 0,
          nb::sig("def farthest_sample(points: numpy.typing.NDArray[numpy.float64],"
                  " triangles: numpy.typing.NDArray[numpy.int64], step: float,"
                  " surface_points: numpy.typing.NDArray[numpy.float64], surface_triangles: "
                  "numpy.typing.NDArray[numpy.int64],"
                  " threads: int = 0) -> tuple[float, tuple[float, float, float]]"),
          R"(The sample of one triangle surface that is farthest from another: its distance and where it is.

Samples are the corners and, regularly, points inside the triangles and on their edges, neighbours at most ``step``
apart; 0 for the corners alone.)");
    m.def("surface_curvatures", &curvature_arrays, nb::arg("surface_points"), nb::arg("triangles"), nb::arg("patch"),
          nb::sig("def surface_curvatures(surface_points: numpy.typing.NDArray[numpy.float64],"
                  " triangles: numpy.typing.NDArray[numpy.int64], patch: numpy.typing.NDArray[numpy.int64])"
                  " -> numpy.typing.NDArray[numpy.float64]"),
          R"(Principal curvatures (t, 6) at the three corners of each triangle as its patch sees them, the larger first.

Positive where the surface bends away from its normal; zero on planar patches.)");
}

} // namespace wct::bindings
