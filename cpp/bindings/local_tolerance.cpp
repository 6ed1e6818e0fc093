#include "bindings/bindings.h"
#include "bindings/domain.h"
#include "bindings/workers.h"

#include "domain/local_tolerance.h"

#include <nanobind/ndarray.h>

namespace nb = nanobind;

namespace wct::bindings {

namespace {

nb::object local_tolerance(const Array &points, const Array &triangles, const Array &patch, const Array &segments,
                           const Array &curve, const Array &sides, double tolerance, double floor, double flat,
                           unsigned threads) {
    domain::SurfaceData surface = surface_of(points_of(points), triangles, "triangles", patch, "patch", sides);
    surface.segments = cells_of<2>(segments, surface.points.size(), "segments");
    surface.curve = curves_of(curve, surface.segments.size(), surface.triangles.size(), "curve");
    surface.flat = flat;
    if (!(tolerance > 0.0 && floor >= 0.0))
        refuse("tolerance must be positive, and floor not negative");
    std::vector<double> found;
    {
        nb::gil_scoped_release release;
        const domain::Reference reference(std::move(surface));
        found = domain::local_tolerance(reference, tolerance, floor, workers_of(threads));
    }
    return nb::cast(array_of<double>(found));
}

} // namespace

void bind_local_tolerance(nb::module_ &m) {
    m.def("local_tolerance", &local_tolerance, nb::arg("points"), nb::arg("triangles"), nb::arg("patch"),
          nb::arg("segments"), nb::arg("curve"), nb::arg("sides"), nb::kw_only(), nb::arg("tolerance"),
          nb::arg("floor"), nb::arg("flat") = 0.0, nb::arg("threads") = 0);
}

} // namespace wct::bindings
