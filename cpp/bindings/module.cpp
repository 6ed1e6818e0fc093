#include "bindings/bindings.h"

#include <nanobind/nanobind.h>

NB_MODULE(_core, m) {
    m.doc() = R"(Compiled core of wct_plugin: arrays in, arrays out.

Arrays are C-contiguous, float64 for coordinates and int64 for indices unless stated; a wrong type, shape or index
raises ValueError. Inputs are never changed. The interpreter is free to run other threads meanwhile.

``threads`` is how many a function works with at most; 0 means OMP_NUM_THREADS, or one per core where that is not set.
The results are the same bits whatever it is.)";
    wct::bindings::bind_move_vertices(m);
    wct::bindings::bind_delaunay(m);
    wct::bindings::bind_geometry(m);
    wct::bindings::bind_resample(m);
    wct::bindings::bind_conform(m);
    wct::bindings::bind_refill(m);
    wct::bindings::bind_measure(m);
    wct::bindings::bind_local_tolerance(m);
    wct::bindings::bind_number_text(m);
    wct::bindings::bind_search(m);
}
