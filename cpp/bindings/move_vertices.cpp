#include "move_vertices/move_vertices.h"
#include "base/monitor.h"
#include "bindings/attributes.h"
#include "bindings/bindings.h"
#include "energy/energy.h"
#include "geometry/predicates.h"
#include "move_vertices/moving_mesh.h"
#include "move_vertices/objective.h"
#include "move_vertices/problem.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

namespace nb = nanobind;

namespace wct::bindings {

namespace {

int sign_of(const std::vector<Vec3> &points, const Tet &tet) {
    const auto corner = [&](std::size_t i) -> const Vec3 & { return points[static_cast<std::size_t>(tet[i])]; };
    return geometry::orient3d(corner(0), corner(1), corner(2), corner(3));
}

auto fresh_points(std::span<const Vec3> points) {
    auto values = std::make_unique<double[]>(3 * points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        values[3 * i] = points[i].x;
        values[3 * i + 1] = points[i].y;
        values[3 * i + 2] = points[i].z;
    }
    return fresh(std::move(values), points.size(), 3);
}

energy::EnergyForm form_of(double margin3, double power3, double margin2, double power2, double weight2,
                           double weight_quality) {
    if (!(power3 >= 1.0) || !(power2 >= 1.0))
        throw nb::value_error("powers must be at least 1");
    return {margin3, power3, margin2, power2, weight2, weight_quality};
}

nb::tuple tet_energy(const Array &points, const Array &tets, double margin3, double power3, double margin2,
                     double power2, double weight2, double weight_quality) {
    const auto at = points_of(points);
    const auto cells = cells_of<4>(tets, at.size(), "tets");
    const energy::EnergyForm form = form_of(margin3, power3, margin2, power2, weight2, weight_quality);
    auto energies = std::make_unique<double[]>(cells.size());
    std::vector<Vec3> gradient(at.size());
    {
        nb::gil_scoped_release release;
        energy::TermLanes terms{};
        for (int lane = 0; lane < energy::kLanes; ++lane) {
            terms.flatness[lane] = energy::kDegenerate;
            terms.height[lane] = terms.cosine[lane] = -std::numeric_limits<double>::infinity();
            terms.weight[lane] = 1.0;
        }
        energy::TetLanes lanes;
        energy::ShapeLanes shape;
        energy::SlopeLanes slopes;
        energy::GradientLanes pulled;
        energy::Lanes energy;
        std::vector<std::int32_t> which;
        for (std::size_t first = 0; first < cells.size(); first += energy::kLanes) {
            const std::size_t count = std::min<std::size_t>(energy::kLanes, cells.size() - first);
            which.clear();
            for (std::size_t k = 0; k < count; ++k)
                which.push_back(static_cast<std::int32_t>(first + k));
            move_vertices::load_tets(at, cells, which, lanes);
            energy::measure(lanes, form.cosines(), shape);
            energy::penalize(shape, form, terms, energy, slopes);
            energy::differentiate(lanes, shape, slopes, form.cosines(), pulled);
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
    return nb::make_tuple(fresh(std::move(energies), cells.size()), fresh_points(std::span<const Vec3>(gradient)));
}

nb::tuple star_energy(const Array &points, const Array &tets, std::int64_t point, double margin3, double power3,
                      double margin2, double power2, double weight2, double weight_quality) {
    auto at = points_of(points);
    auto cells = cells_of<4>(tets, at.size(), "tets");
    const energy::EnergyForm form = form_of(margin3, power3, margin2, power2, weight2, weight_quality);
    if (point < 0 || point >= static_cast<std::int64_t>(at.size()))
        throw nb::value_error(("there is no point " + std::to_string(point)).c_str());
    std::vector<bool> free(at.size());
    free[static_cast<std::size_t>(point)] = true;
    const move_vertices::MovingMesh mesh(std::move(at), std::move(cells), free);
    std::vector<energy::TetLanes> lanes;
    Vec3 gradient;
    double energy = 0.0;
    if (!mesh.free().empty()) {
        std::size_t work = 0;
        move_vertices::load_star(mesh, mesh.free().front(), lanes);
        energy = move_vertices::Objective(form).star(mesh, mesh.free().front(), lanes, gradient, work);
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

/// A mesh, and where on its surface each point is: an InStrata.
move_vertices::Problem problem_of(const Array &points, const Array &tets, nb::handle strata) {
    move_vertices::Problem problem;
    problem.points = points_of(points);
    const std::size_t size = problem.points.size();
    problem.tets = cells_of<4>(tets, size, "tets");
    problem.stratum = strata_of(attribute<Array>(strata, "stratum"), size);
    problem.label = labels_of(attribute<Array>(strata, "label"), size, "label");
    problem.triangles = cells_of<3>(attribute<Array>(strata, "triangles"), size, "triangles");
    problem.triangle_patch = labels_of(attribute<Array>(strata, "patch"), problem.triangles.size(), "patch");
    problem.segments = cells_of<2>(attribute<Array>(strata, "segments"), size, "segments");
    problem.segment_curve = labels_of(attribute<Array>(strata, "curve"), problem.segments.size(), "curve");
    for (std::size_t t = 0; t < problem.tets.size(); ++t)
        if (sign_of(problem.points, problem.tets[t]) <= 0)
            throw nb::value_error(("tet " + std::to_string(t) + " is inverted or flat").c_str());
    return problem;
}

nb::tuple move_vertices(const Array &points, const Array &tets, nb::handle strata, const std::string &goal,
                        double margin, int effort, double tolerance, const nb::object &progress) {
    const move_vertices::Problem problem = problem_of(points, tets, strata);
    if (goal != "3wc" && goal != "cwc")
        throw nb::value_error(("goal " + goal + "; allowed are 3wc and cwc").c_str());
    if (!(margin >= 0.0 && margin < 1.0 / 3.0))
        throw nb::value_error("margin must lie in 0..1/3, the value of the regular tet");
    if (effort < 1 || effort > 1000)
        throw nb::value_error("effort must lie in 1..1000");
    if (!(tolerance > 0.0))
        throw nb::value_error("tolerance must be positive");
    Monitor monitor([&](double done, std::int64_t bad) { return goes_on(progress, std::min(done, 1.0), bad); });
    const move_vertices::Aim aim{goal == "3wc" ? move_vertices::Goal::well_centered
                                               : move_vertices::Goal::completely_well_centered,
                                 margin, effort, tolerance};
    const auto count = static_cast<std::int64_t>(problem.tets.size());
    move_vertices::Result result;
    {
        nb::gil_scoped_release release;
        result = move_vertices::well_center(problem, aim, monitor);
    }
    nb::dict report;
    report["iterations"] = monitor.iterations();
    report["evaluations"] = monitor.evaluations();
    report["bad_before"] = count - result.before.meeting;
    report["bad_after"] = count - result.after.meeting;
    report["worst_before"] = result.before.worst;
    report["worst_after"] = result.after.worst;
    report["stopped"] = monitor.stopped();
    return nb::make_tuple(fresh_points(std::span<const Vec3>(result.points)), report);
}

void bind_energies(nb::module_ &m) {
    using namespace nb::literals;
    m.def("tet_energy", &tet_energy, "points"_a, "tets"_a, nb::kw_only(), "margin3"_a, "power3"_a, "margin2"_a,
          "power2"_a, "weight2"_a, "weight_quality"_a,
          nb::sig("def tet_energy(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64],"
                  " *, margin3: float, power3: float, margin2: float, power2: float, weight2: float,"
                  " weight_quality: float)"
                  " -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]"),
          R"(How far each tet is from being well-centered, and which way is better.

::

    E = sum over 4 facets         max(0, margin3 - h/R)^power3
      + weight2 * sum over 12 angles  max(0, margin2 - cos)^power2
      + weight_quality * sum over 4 facets  (h/R - 1/3)^2

with h the signed height of the circumcenter over the facet, R the circumradius and cos the cosines of the facet angles.
Powers are at least 1; multiples of one half up to 3 are quickest.

``points`` (n, 3), ``tets`` (m, 4). Returns the energies (m,) and the gradient (n, 3) of their sum. A tet that is
inverted or flat, det <= 1e-5 longest_edge^3, has infinite energy and no part in the gradient.

Raises
------
ValueError
    Where an array has a wrong type, shape or index, or a power is below 1.)");
    m.def(
        "star_energy", &star_energy, "points"_a, "tets"_a, "point"_a, nb::kw_only(), "margin3"_a, "power3"_a,
        "margin2"_a, "power2"_a, "weight2"_a, "weight_quality"_a,
        nb::sig("def star_energy(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64],"
                " point: int, *, margin3: float, power3: float, margin2: float, power2: float, weight2: float,"
                " weight_quality: float) -> tuple[float, numpy.typing.NDArray[numpy.float64]]"),
        R"(The energy of :func:`tet_energy` summed over the tets around one point, and its gradient (3,) in that point.

Here a tet may be as flat as it is; it is infinite where one is inverted.)");
}

} // namespace

void bind_move_vertices(nb::module_ &m) {
    using namespace nb::literals;
    bind_energies(m);
    m.def(
        "orientation", &orientation, "points"_a, "tets"_a,
        nb::sig("def orientation(points: numpy.typing.NDArray[numpy.float64], tets: numpy.typing.NDArray[numpy.int64])"
                " -> numpy.typing.NDArray[numpy.int8]"),
        R"(Exact sign of det(x1-x0, x2-x0, x3-x0) per tet: 1, -1, or 0 for four coplanar points.

``points`` (n, 3) finite, ``tets`` (m, 4); returns (m,).)");
    m.def(
        "move_vertices", &move_vertices, "points"_a, "tets"_a, "strata"_a, nb::kw_only(), "goal"_a, "margin"_a,
        "effort"_a, "tolerance"_a = std::numeric_limits<double>::infinity(), "progress"_a = nb::none(),
        nb::sig("def move_vertices(points: numpy.typing.NDArray[numpy.float64],"
                " tets: numpy.typing.NDArray[numpy.int64], strata: wct_plugin.core.domain.InStrata, *,"
                " goal: typing.Literal['3wc', 'cwc'], margin: float, effort: int, tolerance: float = ...,"
                " progress: collections.abc.Callable[[float, int], typing.Any] | None = None)"
                " -> tuple[numpy.typing.NDArray[numpy.float64], wct_plugin.core.results.MoveReport]"),
        R"(Move vertices so that as many tets as possible contain their circumcenter ("3wc"), and have acute facets ("cwc").

Parameters
----------
points, tets
    (n, 3) and (m, 4), all positive.
strata
    What each point may do: those inside move freely, those of a patch on its triangles, those of a crease on its
    segments, corners stay. Triangles and segments lie where the points are now. Flat patches and straight creases stay
    so to rounding.
margin
    0 to 1/3, the clearance wanted in h/R, and in the cosines for cwc.
effort
    1 to 1000, multiplies the iterations.
tolerance
    A length, without limit by default: how far curved patches, as the moved points span them, may be from where they
    are now, patch by patch and both ways; and curved creases likewise. Planes and straight creases know none.
progress
    ``progress(done, bad)`` hears the done fraction and the number of tets that miss the goal so far; if it returns
    something false other than None, the best positions so far are returned; if it raises, that propagates, as does
    KeyboardInterrupt.

Returns
-------
tuple
    The points (n, 3), and what was done. Whatever happens, no tet is inverted and no fewer contain their circumcenter
    than before, both exactly; points that may not move keep their bits; the same input gives the same bits.

Raises
------
ValueError
    Where an array has a wrong type, shape or index, an option a value that is not allowed, or a tet is inverted.)");
}

} // namespace wct::bindings
