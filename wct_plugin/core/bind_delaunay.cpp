#include "bindings.h"

#include "delaunay.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace nb = nanobind;

namespace wct {

namespace {

using Points = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Quads = nb::ndarray<nb::numpy, std::int64_t, nb::shape<-1, 4>, nb::c_contig>;

/// A NumPy array that owns a widened copy.
Quads quads(const std::vector<std::array<int, 4>> &rows) {
    auto values = std::make_unique<std::int64_t[]>(4 * rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
        std::copy(rows[i].begin(), rows[i].end(), &values[4 * i]);
    nb::capsule owner(values.get(), [](void *data) noexcept { delete[] static_cast<std::int64_t *>(data); });
    return Quads(values.release(), {rows.size(), 4}, owner);
}

std::pair<Quads, Quads> delaunay_arrays(const Points &points) {
    Triangulation mesh;
    {
        nb::gil_scoped_release release;
        std::vector<Vec3> copy(points.shape(0));
        for (std::size_t i = 0; i < copy.size(); ++i)
            copy[i] = {points(i, 0), points(i, 1), points(i, 2)};
        mesh = delaunay(copy);
    }
    return {quads(mesh.tets), quads(mesh.neighbours)};
}

} // namespace

void bind_delaunay(nb::module_ &m) {
    m.def("delaunay", &delaunay_arrays, nb::arg("points"),
          "Delaunay tetrahedralization of (n, 3) points.\n\n"
          "Returns tets (m, 4), positively oriented, and neighbours (m, 4): the tet across the facet opposite each\n"
          "vertex, -1 on the hull. Exact: no point lies inside a circumsphere and no tet is flat. Raises ValueError\n"
          "for fewer than four points and for points that are not finite, coincide or all lie in one plane.");
}

} // namespace wct
