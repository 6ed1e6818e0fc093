#pragma once

#include "bindings/arrays.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace wct::bindings {

/// What objects of wct_plugin.core.domain and wct_plugin.core.requests hold: read by name, each checked where it is
/// used. Any object with these attributes will do.

/// An attribute of this type; TypeError with its name where it has another.
template <class T> T attribute(nanobind::handle of, const char *name) {
    const nanobind::object value = of.attr(name);
    T out;
    if (!nanobind::try_cast(value, out))
        throw nanobind::type_error(
            (std::string(name) + " is a " + nanobind::cast<std::string>(value.type().attr("__name__"))).c_str());
    return out;
}

/// The same, where the attribute may be None.
template <class T> std::optional<T> maybe(nanobind::handle of, const char *name) {
    if (of.attr(name).is_none())
        return {};
    return attribute<T>(of, name);
}

/// A mask of `count` numbers, of those that an attribute lists; it may be None.
inline std::vector<std::uint8_t> listed(nanobind::handle of, const char *name, std::size_t count) {
    std::vector<std::uint8_t> mask(count, 0);
    if (const auto given = maybe<Array>(of, name))
        for (const int k : numbers_of(*given, static_cast<std::int64_t>(count), name))
            mask[k] = 1;
    return mask;
}

/// An object of one of the classes of wct_plugin.core, from its fields.
inline nanobind::object made(const char *module, const char *type, const nanobind::dict &fields) {
    return nanobind::module_::import_(module).attr(type)(**fields);
}

} // namespace wct::bindings
