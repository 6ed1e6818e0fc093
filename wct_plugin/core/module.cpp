#include "energy.h"
#include "monitor.h"
#include "moving_mesh.h"
#include "objective.h"
#include "predicates.h"
#include "problem.h"
#include "well_center.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>

namespace nb = nanobind;

namespace wct {

namespace {

using Array = nb::ndarray<nb::ro, nb::device::cpu, nb::c_contig>;

std::string shape_of(const Array &array) {
    std::string out = "(";
    for (std::size_t i = 0; i < array.ndim(); ++i)
        out += (i ? ", " : "") + std::to_string(array.shape(i));
    return out + ")";
}

/// The rows of a (n,) array (columns = 0) or a (n, columns) array, of this type exactly; ValueError otherwise.
template <class T> std::span<const T> rows(const Array &array, std::size_t columns, const char *name) {
    if (array.dtype() != nb::dtype<T>())
        throw nb::value_error((std::string(name) + " must hold " + (std::is_floating_point_v<T> ? "float" : "int") +
                               std::to_string(8 * sizeof(T)))
                                  .c_str());
    if (array.ndim() != (columns ? 2 : 1) || (columns && array.shape(1) != columns))
        throw nb::value_error((std::string(name) + " has shape " + shape_of(array) + "; allowed is (n" +
                               (columns ? ", " + std::to_string(columns) : ",") + ")")
                                  .c_str());
    return {static_cast<const T *>(array.data()), array.size()};
}

void expect_length(std::size_t length, std::size_t expected, const char *name) {
    if (length != expected)
        throw nb::value_error(
            (std::string(name) + " has length " + std::to_string(length) + "; it must be " + std::to_string(expected))
                .c_str());
}

std::vector<Vec3> points_of(const Array &array) {
    const auto values = rows<double>(array, 3, "points");
    std::vector<Vec3> out(values.size() / 3);
    for (std::size_t i = 0; i < out.size(); ++i) {
        out[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
        if (!std::isfinite(out[i].x) || !std::isfinite(out[i].y) || !std::isfinite(out[i].z))
            throw nb::value_error(("point " + std::to_string(i) + " is not finite").c_str());
    }
    if (out.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
        throw nb::value_error("too many points");
    return out;
}

template <std::size_t corners>
std::vector<std::array<std::int32_t, corners>> cells_of(const Array &array, std::size_t points, const char *name) {
    const auto values = rows<std::int64_t>(array, corners, name);
    std::vector<std::array<std::int32_t, corners>> out(values.size() / corners);
    if (out.size() >= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
        throw nb::value_error((std::string("too many ") + name).c_str());
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i] < 0 || values[i] >= static_cast<std::int64_t>(points))
            throw nb::value_error((std::string(name) + " names point " + std::to_string(values[i]) + "; there are " +
                                   std::to_string(points))
                                      .c_str());
        out[i / corners][i % corners] = static_cast<std::int32_t>(values[i]);
    }
    return out;
}

std::vector<std::int64_t> labels_of(const Array &array, std::size_t length, const char *name) {
    const auto values = rows<std::int64_t>(array, 0, name);
    expect_length(values.size(), length, name);
    return {values.begin(), values.end()};
}

int sign_of(const std::vector<Vec3> &points, const Tet &tet) {
    const auto corner = [&](std::size_t i) -> const Vec3 & { return points[static_cast<std::size_t>(tet[i])]; };
    return orient3d(corner(0), corner(1), corner(2), corner(3));
}

/// A new NumPy array that owns its values.
template <class T, class... Shape> auto fresh(std::unique_ptr<T[]> values, Shape... shape) {
    T *data = values.get();
    nb::capsule owner(data, [](void *p) noexcept { delete[] static_cast<T *>(p); });
    values.release();
    return nb::ndarray<nb::numpy, T, nb::ndim<sizeof...(Shape)>, nb::c_contig>(
        data, {static_cast<std::size_t>(shape)...}, owner);
}

auto fresh(std::span<const Vec3> points) {
    auto values = std::make_unique<double[]>(3 * points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        values[3 * i] = points[i].x;
        values[3 * i + 1] = points[i].y;
        values[3 * i + 2] = points[i].z;
    }
    return fresh(std::move(values), points.size(), 3);
}

EnergyForm form_of(double margin3, double power3, double margin2, double power2, double weight2,
                   double weight_quality) {
    if (!(power3 >= 1.0) || !(power2 >= 1.0))
        throw nb::value_error("powers must be at least 1");
    return {margin3, power3, margin2, power2, weight2, weight_quality};
}

nb::tuple tet_energy(const Array &points, const Array &tets, double margin3, double power3, double margin2,
                     double power2, double weight2, double weight_quality) {
    const auto at = points_of(points);
    const auto cells = cells_of<4>(tets, at.size(), "tets");
    const EnergyForm form = form_of(margin3, power3, margin2, power2, weight2, weight_quality);
    auto energies = std::make_unique<double[]>(cells.size());
    std::vector<Vec3> gradient(at.size());
    {
        nb::gil_scoped_release release;
        TermLanes terms{};
        for (int lane = 0; lane < kLanes; ++lane) {
            terms.flatness[lane] = kDegenerate;
            terms.height[lane] = terms.cosine[lane] = -std::numeric_limits<double>::infinity();
            terms.weight[lane] = 1.0;
        }
        TetLanes lanes;
        ShapeLanes shape;
        SlopeLanes slopes;
        GradientLanes pulled;
        Lanes energy;
        std::vector<std::int32_t> which;
        for (std::size_t first = 0; first < cells.size(); first += kLanes) {
            const std::size_t count = std::min<std::size_t>(kLanes, cells.size() - first);
            which.clear();
            for (std::size_t k = 0; k < count; ++k)
                which.push_back(static_cast<std::int32_t>(first + k));
            load_tets(at, cells, which, lanes);
            measure(lanes, form.cosines(), shape);
            penalize(shape, form, terms, energy, slopes);
            differentiate(lanes, shape, slopes, form.cosines(), pulled);
            for (std::size_t k = 0; k < count; ++k) {
                const int lane = static_cast<int>(k);
                energies[first + k] = energy[lane];
                if (std::isfinite(energy[lane]))
                    for (std::size_t i = 0; i < 4; ++i)
                        gradient[static_cast<std::size_t>(cells[first + k][i])] +=
                            {pulled.corner[i][0][lane], pulled.corner[i][1][lane], pulled.corner[i][2][lane]};
            }
        }
    }
    return nb::make_tuple(fresh(std::move(energies), cells.size()), fresh(std::span<const Vec3>(gradient)));
}

nb::tuple star_energy(const Array &points, const Array &tets, std::int64_t point, double margin3, double power3,
                      double margin2, double power2, double weight2, double weight_quality) {
    auto at = points_of(points);
    auto cells = cells_of<4>(tets, at.size(), "tets");
    const EnergyForm form = form_of(margin3, power3, margin2, power2, weight2, weight_quality);
    if (point < 0 || point >= static_cast<std::int64_t>(at.size()))
        throw nb::value_error(("there is no point " + std::to_string(point)).c_str());
    std::vector<bool> free(at.size());
    free[static_cast<std::size_t>(point)] = true;
    const MovingMesh mesh(std::move(at), std::move(cells), free);
    std::vector<TetLanes> lanes;
    Vec3 gradient;
    double energy = 0.0;
    if (!mesh.free().empty()) {
        std::size_t work = 0;
        load_star(mesh, mesh.free().front(), lanes);
        energy = Objective(form).star(mesh, mesh.free().front(), lanes, gradient, work);
    }
    auto values = std::make_unique<double[]>(3);
    values[0] = gradient.x;
    values[1] = gradient.y;
    values[2] = gradient.z;
    return nb::make_tuple(energy, fresh(std::move(values), 3));
}

auto orientation(const Array &points, const Array &tets) {
    const auto at = points_of(points);
    const auto cells = cells_of<4>(tets, at.size(), "tets");
    auto signs = std::make_unique<std::int8_t[]>(cells.size());
    {
        nb::gil_scoped_release release;
        for (std::size_t t = 0; t < cells.size(); ++t)
            signs[t] = static_cast<std::int8_t>(sign_of(at, cells[t]));
    }
    return fresh(std::move(signs), cells.size());
}

std::vector<Stratum> strata_of(const Array &array, std::size_t count) {
    const auto values = rows<std::int8_t>(array, 0, "stratum");
    expect_length(values.size(), count, "stratum");
    std::vector<Stratum> out;
    for (const auto value : values) {
        if (value < 0 || value > 3)
            throw nb::value_error(("stratum " + std::to_string(value) + "; allowed are 0, 1, 2 and 3").c_str());
        out.push_back(static_cast<Stratum>(value));
    }
    return out;
}

nb::tuple move_vertices(const Array &points, const Array &tets, const Array &stratum, const Array &label,
                        const Array &triangles, const Array &triangle_patch, const Array &segments,
                        const Array &segment_curve, const std::string &goal, double margin, int effort,
                        double tolerance, const std::optional<nb::callable> &progress) {
    Problem problem;
    problem.points = points_of(points);
    const std::size_t size = problem.points.size();
    problem.tets = cells_of<4>(tets, size, "tets");
    problem.stratum = strata_of(stratum, size);
    problem.label = labels_of(label, size, "label");
    problem.triangles = cells_of<3>(triangles, size, "triangles");
    problem.triangle_patch = labels_of(triangle_patch, problem.triangles.size(), "triangle_patch");
    problem.segments = cells_of<2>(segments, size, "segments");
    problem.segment_curve = labels_of(segment_curve, problem.segments.size(), "segment_curve");
    if (goal != "3wc" && goal != "cwc")
        throw nb::value_error(("goal " + goal + "; allowed are 3wc and cwc").c_str());
    if (!(margin >= 0.0 && margin < 1.0 / 3.0))
        throw nb::value_error("margin must lie in 0..1/3, the value of the regular tet");
    if (effort < 1 || effort > 1000)
        throw nb::value_error("effort must lie in 1..1000");
    if (!(tolerance > 0.0))
        throw nb::value_error("tolerance must be positive");
    for (std::size_t t = 0; t < problem.tets.size(); ++t)
        if (sign_of(problem.points, problem.tets[t]) <= 0)
            throw nb::value_error(("tet " + std::to_string(t) + " is inverted or flat").c_str());

    Monitor monitor([&](double done, std::int64_t bad) {
        nb::gil_scoped_acquire acquire;
        if (PyErr_CheckSignals() != 0)
            throw nb::python_error();
        if (!progress)
            return true;
        const nb::object answer = (*progress)(std::min(done, 1.0), bad);
        const int truth = answer.is_none() ? 1 : PyObject_IsTrue(answer.ptr()); // a listener that says nothing goes on
        if (truth < 0)
            throw nb::python_error();
        return truth != 0;
    });
    const Aim aim{goal == "3wc" ? Goal::well_centered : Goal::completely_well_centered, margin, effort, tolerance};
    const auto count = static_cast<std::int64_t>(problem.tets.size());
    Result result;
    {
        nb::gil_scoped_release release;
        result = well_center(problem, aim, monitor);
    }
    nb::dict report;
    report["iterations"] = monitor.iterations();
    report["evaluations"] = monitor.evaluations();
    report["bad_before"] = count - result.before.meeting;
    report["bad_after"] = count - result.after.meeting;
    report["worst_before"] = result.before.worst;
    report["worst_after"] = result.after.worst;
    report["stopped"] = monitor.stopped();
    return nb::make_tuple(fresh(std::span<const Vec3>(result.points)), report);
}

} // namespace

} // namespace wct

NB_MODULE(_core, m) {
    m.doc() = "Compiled core of wct_plugin: arrays in, arrays out.";
    using namespace nb::literals;
    m.def("tet_energy", &wct::tet_energy, "points"_a, "tets"_a, nb::kw_only(), "margin3"_a, "power3"_a, "margin2"_a,
          "power2"_a, "weight2"_a, "weight_quality"_a);
    m.def("star_energy", &wct::star_energy, "points"_a, "tets"_a, "point"_a, nb::kw_only(), "margin3"_a, "power3"_a,
          "margin2"_a, "power2"_a, "weight2"_a, "weight_quality"_a);
    m.def("orientation", &wct::orientation, "points"_a, "tets"_a);
    m.def("move_vertices", &wct::move_vertices, "points"_a, "tets"_a, "stratum"_a, "label"_a, "triangles"_a,
          "triangle_patch"_a, "segments"_a, "segment_curve"_a, nb::kw_only(), "goal"_a, "margin"_a, "effort"_a,
          "tolerance"_a = std::numeric_limits<double>::infinity(), "progress"_a = nb::none());
}
