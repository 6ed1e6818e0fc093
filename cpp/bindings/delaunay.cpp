#include "bindings/arrays.h"
#include "bindings/bindings.h"

#include "delaunay/delaunay.h"

namespace nb = nanobind;

namespace wct::bindings {

namespace {

nb::tuple delaunay_arrays(const Array &points) {
    const auto at = points_of(points);
    delaunay::Triangulation mesh;
    {
        nb::gil_scoped_release release;
        mesh = delaunay::delaunay(at);
    }
    return nb::make_tuple(array_of<std::int64_t>(mesh.tets), array_of<std::int64_t>(mesh.neighbours));
}

} // namespace

void bind_delaunay(nb::module_ &m) {
    m.def("delaunay", &delaunay_arrays, nb::arg("points"),
          nb::sig("def delaunay(points: numpy.typing.NDArray[numpy.float64])"
                  " -> tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int64]]"),
          R"(Delaunay tetrahedralization of ``points`` (n, 3).

Returns tets (m, 4), positively oriented, and neighbours (m, 4): the tet across the facet opposite each vertex, -1 on
the hull. Exact: no point lies inside a circumsphere and no tet is flat.

Raises
------
ValueError
    For fewer than four points, and for points that are not finite, coincide or all lie in one plane.)");
}

} // namespace wct::bindings
