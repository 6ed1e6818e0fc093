#pragma once

#include <nanobind/nanobind.h>

namespace wct {

/// Each adds its part to the module.
void bind_conform(nanobind::module_ &m);
void bind_delaunay(nanobind::module_ &m);
void bind_global(nanobind::module_ &m);
void bind_interior(nanobind::module_ &m);
void bind_search(nanobind::module_ &m);

} // namespace wct
