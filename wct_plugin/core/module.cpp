#include <nanobind/nanobind.h>

NB_MODULE(_core, m) {
    m.doc() = "Compiled core of wct_plugin: arrays in, arrays out.";
}
