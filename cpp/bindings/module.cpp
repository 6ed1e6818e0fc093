#include "bindings/bindings.h"

#include <nanobind/nanobind.h>

NB_MODULE(_core, m) {
    m.doc() = "Compiled core of wct_plugin: arrays in, arrays out.";
    wct::bindings::bind_move_vertices(m);
    wct::bindings::bind_delaunay(m);
    wct::bindings::bind_geometry(m);
    wct::bindings::bind_resample(m);
    wct::bindings::bind_conform(m);
    wct::bindings::bind_refill(m);
    wct::bindings::bind_local_tolerance(m);
    wct::bindings::bind_number_text(m);
    wct::bindings::bind_search(m);
}
