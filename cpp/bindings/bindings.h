#pragma once

#include <nanobind/nanobind.h>

namespace wct::bindings {

/// Each adds its part to the module.
void bind_conform(nanobind::module_ &m);
void bind_move_vertices(nanobind::module_ &m);
void bind_delaunay(nanobind::module_ &m);
void bind_geometry(nanobind::module_ &m);
void bind_resample(nanobind::module_ &m);
void bind_refill(nanobind::module_ &m);
void bind_measure(nanobind::module_ &m);
void bind_local_tolerance(nanobind::module_ &m);
void bind_number_text(nanobind::module_ &m);
void bind_search(nanobind::module_ &m);

} // namespace wct::bindings
