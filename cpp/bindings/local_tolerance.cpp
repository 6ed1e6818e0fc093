#include "bindings/bindings.h"
#include "bindings/domain.h"
#include "bindings/workers.h"

#include "domain/local_tolerance.h"

#include <nanobind/ndarray.h>

namespace nb = nanobind;

namespace wct::bindings {

namespace {

nb::object local_tolerance(nb::handle on, double tolerance, double floor, unsigned threads) {
    domain::SurfaceData surface = surface_of(on);
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
    m.def("local_tolerance", &local_tolerance, nb::arg("surface"), nb::kw_only(), nb::arg("tolerance"),
          nb::arg("floor"), nb::arg("threads") = 0,
          nb::sig("def local_tolerance(surface: wct_plugin.core.domain.StratifiedSurface, *, tolerance: float,"
                  " floor: float, threads: int = 0) -> numpy.typing.NDArray[numpy.float64]"),
          R"(Per point of a surface, (n,), a tenth of the wall, gap or radius there, within ``floor``..``tolerance``.

All are lengths. ``threads`` as of resample.

Raises
------
ValueError
    Where an array has a wrong type, shape or index, or a length is not positive.)");
}

} // namespace wct::bindings
