#include "bindings/arrays.h"
#include "bindings/bindings.h"

#include "base/number_text.h"

#include <nanobind/stl/optional.h>

#include <optional>

namespace nb = nanobind;

namespace wct::bindings {

namespace {

template <class Number>
nb::tuple read(const nb::bytes &text, const nb::bytes &head, const nb::bytes &stop, std::size_t start,
               std::optional<std::size_t> lines) {
    NumberPlaces places;
    places.start = start;
    places.lines = lines.value_or(places.lines);
    places.head = {head.c_str(), head.size()};
    places.stop = stop.size() ? *stop.c_str() : '\0';
    NumberText<Number> found;
    {
        nb::gil_scoped_release release;
        found = read_numbers<Number>({text.c_str(), text.size()}, places);
    }
    return nb::make_tuple(array_of<Number>(found.values), array_of<std::int64_t>(found.widths), found.end, found.good);
}

} // namespace

void bind_number_text(nb::module_ &m) {
    m.def(
        "read_reals", &read<double>, nb::arg("text"), nb::arg("head") = nb::bytes(""), nb::arg("stop") = nb::bytes(""),
        nb::arg("start") = 0, nb::arg("lines") = nb::none(),
        nb::sig("def read_reals(text: bytes, head: bytes = b'', stop: bytes = b'', start: int = 0,"
                " lines: int | None = None)"
                " -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.int64], int, bool]"),
        R"(The numbers of a text (n,), how many each line has that is read, where reading ended, and whether all is well.

Blanks part numbers; each is rounded to nearest. Exponents may be Fortran's D. Without a ``head`` all lines are read
that have any word; with one, in small letters, those that begin with it, behind it. What of a word is behind the letter
``stop`` is left out. ``start``: where to begin; ``lines``: how many are read at most. Reading ends behind the last
line, or at the first word that is no number, and then all is not well.)");
    m.def("read_integers", &read<std::int64_t>, nb::arg("text"), nb::arg("head") = nb::bytes(""),
          nb::arg("stop") = nb::bytes(""), nb::arg("start") = 0, nb::arg("lines") = nb::none(),
          nb::sig("def read_integers(text: bytes, head: bytes = b'', stop: bytes = b'', start: int = 0,"
                  " lines: int | None = None)"
                  " -> tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int64], int, bool]"),
          R"(The same of whole numbers; these may have a point and an exponent.)");
}

} // namespace wct::bindings
