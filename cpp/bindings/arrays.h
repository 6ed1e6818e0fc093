#pragma once

#include "base/cells.h"
#include "base/vec3.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace wct::bindings {

/// NumPy arrays in and out. What comes in is checked: a wrong type, shape or index is a ValueError that names the
/// array, the value and what is allowed.
using Array = nanobind::ndarray<nanobind::ro, nanobind::device::cpu, nanobind::c_contig>;

[[noreturn]] inline void refuse(const std::string &message) {
    throw nanobind::value_error(message.c_str());
}

inline std::string shape_of(const Array &array) {
    std::string out = "(";
    for (std::size_t i = 0; i < array.ndim(); ++i)
        out += (i ? ", " : "") + std::to_string(array.shape(i));
    return out + ")";
}

/// The rows of a (n,) array (columns = 0) or a (n, columns) array, of this type exactly; ValueError otherwise.
template <class T> std::span<const T> rows(const Array &array, std::size_t columns, const char *name) {
    if (array.dtype() != nanobind::dtype<T>())
        refuse(std::string(name) + " must hold " + (std::is_floating_point_v<T> ? "float" : "int") +
               std::to_string(8 * sizeof(T)));
    if (array.ndim() != (columns ? 2 : 1) || (columns && array.shape(1) != columns))
        refuse(std::string(name) + " has shape " + shape_of(array) + "; allowed is (n" +
               (columns ? ", " + std::to_string(columns) : ",") + ")");
    if (array.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
        refuse(std::string("too many ") + name);
    return {static_cast<const T *>(array.data()), array.size()};
}

inline void expect_length(std::size_t length, std::size_t expected, const char *name) {
    if (length != expected)
        refuse(std::string(name) + " has length " + std::to_string(length) + "; it must be " +
               std::to_string(expected));
}

inline std::vector<Vec3> points_of(const Array &array, const char *name = "points") {
    const auto values = rows<double>(array, 3, name);
    std::vector<Vec3> out(values.size() / 3);
    for (std::size_t i = 0; i < out.size(); ++i) {
        out[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
        if (!std::isfinite(out[i].x) || !std::isfinite(out[i].y) || !std::isfinite(out[i].z))
            refuse(std::string(name) + ": point " + std::to_string(i) + " is not finite");
    }
    return out;
}

template <std::size_t corners>
std::vector<std::array<std::int32_t, corners>> cells_of(const Array &array, std::size_t points, const char *name) {
    const auto values = rows<std::int64_t>(array, corners, name);
    std::vector<std::array<std::int32_t, corners>> out(values.size() / corners);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i] < 0 || values[i] >= static_cast<std::int64_t>(points))
            refuse(std::string(name) + " names point " + std::to_string(values[i]) + "; there are " +
                   std::to_string(points));
        out[i / corners][i % corners] = static_cast<std::int32_t>(values[i]);
    }
    return out;
}

/// An (n,) array of numbers in 0..count-1.
inline std::vector<int> numbers_of(const Array &array, std::int64_t count, const char *name) {
    const auto values = rows<std::int64_t>(array, 0, name);
    std::vector<int> out;
    out.reserve(values.size());
    for (const auto value : values) {
        if (value < 0 || value >= count)
            refuse(std::string(name) + " holds " + std::to_string(value) +
                   (count > 0 ? "; allowed are 0.." + std::to_string(count - 1) : "; none is allowed"));
        out.push_back(static_cast<int>(value));
    }
    return out;
}

/// The same of this length.
inline std::vector<int> numbers_of(const Array &array, std::size_t length, std::int64_t count, const char *name) {
    expect_length(rows<std::int64_t>(array, 0, name).size(), length, name);
    return numbers_of(array, count, name);
}

/// A (segments,) array of curve numbers. Some may be left out, but there are no more than edges of a surface.
inline std::vector<int> curves_of(const Array &array, std::size_t segments, std::size_t triangles, const char *name) {
    return numbers_of(array, segments, static_cast<std::int64_t>(segments + 3 * triangles), name);
}

inline std::vector<std::int64_t> labels_of(const Array &array, std::size_t length, const char *name) {
    const auto values = rows<std::int64_t>(array, 0, name);
    expect_length(values.size(), length, name);
    return {values.begin(), values.end()};
}

/// A (length,) array of positive finite numbers.
inline std::vector<double> sizes_of(const Array &array, std::size_t length, const char *name) {
    const auto values = rows<double>(array, 0, name);
    expect_length(values.size(), length, name);
    for (const double value : values)
        if (!(value > 0.0) || !std::isfinite(value))
            refuse(std::string(name) + " holds " + std::to_string(value) + "; it must be positive");
    return {values.begin(), values.end()};
}

inline std::vector<Stratum> strata_of(const Array &array, std::size_t count) {
    const auto values = rows<std::int8_t>(array, 0, "stratum");
    expect_length(values.size(), count, "stratum");
    std::vector<Stratum> out;
    for (const auto value : values) {
        if (value < 0 || value > 3)
            refuse("stratum " + std::to_string(value) + "; allowed are 0, 1, 2 and 3");
        out.push_back(static_cast<Stratum>(value));
    }
    return out;
}

/// A new NumPy array that owns its values.
template <class T, class... Shape> auto fresh(std::unique_ptr<T[]> values, Shape... shape) {
    T *data = values.get();
    nanobind::capsule owner(data, [](void *p) noexcept { delete[] static_cast<T *>(p); });
    values.release();
    return nanobind::ndarray<nanobind::numpy, T, nanobind::ndim<sizeof...(Shape)>, nanobind::c_contig>(
        data, {static_cast<std::size_t>(shape)...}, owner);
}

/// A new NumPy array of `width` columns (0: one-dimensional) that owns what `fill` writes.
template <class T, class Fill> nanobind::object array(std::size_t count, std::size_t width, const Fill &fill) {
    auto values = std::make_unique<T[]>(count * (width ? width : 1));
    fill(values.get());
    return width ? nanobind::cast(fresh(std::move(values), count, width))
                 : nanobind::cast(fresh(std::move(values), count));
}

/// A new NumPy array of `columns` columns (0: one-dimensional) of these values, row by row.
template <class To, class From> nanobind::object array_of(const std::vector<From> &values, std::size_t columns = 0) {
    return array<To>(values.size() / (columns ? columns : 1), columns,
                     [&](To *to) { std::copy(values.begin(), values.end(), to); });
}

/// A new (n, columns) array of these cells' corners.
template <class To, class From, std::size_t columns>
nanobind::object array_of(const std::vector<std::array<From, columns>> &cells) {
    return array<To>(cells.size(), columns, [&](To *to) {
        for (const auto &cell : cells)
            to = std::copy(cell.begin(), cell.end(), to);
    });
}

/// A new (n, 3) array of points.
inline nanobind::object array_of(const std::vector<Vec3> &points) {
    return array<double>(points.size(), 3, [&](double *to) {
        for (const Vec3 &p : points)
            for (const double x : {p.x, p.y, p.z})
                *to++ = x;
    });
}

/// A new (n,) array of the numbers of strata.
inline nanobind::object array_of(const std::vector<Stratum> &strata) {
    return array<std::int8_t>(strata.size(), 0, [&](std::int8_t *to) {
        for (const Stratum stratum : strata)
            *to++ = static_cast<std::int8_t>(stratum);
    });
}

/// Ask a Python listener whether to go on; one that says nothing, and none at all, goes on. Takes the GIL.
template <class... Arguments> bool goes_on(const nanobind::object &progress, const Arguments &...arguments) {
    nanobind::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0)
        throw nanobind::python_error();
    if (progress.is_none())
        return true;
    const nanobind::object answer = progress(arguments...);
    const int truth = answer.is_none() ? 1 : PyObject_IsTrue(answer.ptr());
    if (truth < 0)
        throw nanobind::python_error();
    return truth != 0;
}

} // namespace wct::bindings
