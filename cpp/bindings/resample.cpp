#include "bindings/bindings.h"
#include "bindings/domain.h"
#include "bindings/workers.h"

#include "sampling/resample.h"
#include "sampling/start.h"
#include "sampling/surface_labels.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace nb = nanobind;

namespace wct::bindings {

namespace {

nb::object to_python(const sampling::Resampled &result, const sampling::SurfaceLabels &surface,
                     const std::vector<int> &held) {
    const sampling::Start start = sampling::start_of(result, surface);
    const auto numbers = [&](const std::vector<int> &points) {
        std::vector<int> rows;
        for (const int v : points)
            rows.push_back(start.place[v]);
        return array_of<std::int64_t>(rows);
    };
    std::vector<int> held_point(start.mesh.points.size(), -1);
    for (std::size_t i = 0; i < held.size(); ++i)
        if (start.place[i] >= 0)
            held_point[start.place[i]] = held[i];
    nb::dict stats;
    stats["bad"] = result.tally.bad;
    stats["deviation_out"] = result.deviation.most_out;
    stats["deviation_in"] = result.deviation.most_in;
    stats["volume_gain"] = result.deviation.volume_gain;
    stats["stopped"] = result.stopped;
    for (const auto &[name, value] : result.stats)
        stats[name.c_str()] = value;
    nb::dict out;
    out["mesh"] = object_of(start.mesh);
    out["held"] = array_of<std::int64_t>(held_point);
    out["exposed"] = numbers(result.flaws.exposed);
    out["pinched"] = numbers(result.flaws.pinched);
    out["lost"] = numbers(result.lost);
    out["intact"] = result.intact;
    out["work"] = result.work;
    out["stats"] = stats;
    return made("wct_plugin.core.results", "ResampleResult", out);
}

/// Hand freed memory back to the system: what comes after a large piece of work needs its room in other pieces, and the
/// peak would be the sum of both.
void trim() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

/// Places and a positive number at each.
template <class Place>
std::vector<Place> places_of(const Array &at, const char *at_name, const Array &value, const char *value_name) {
    const std::vector<Vec3> points = points_of(at, at_name);
    const std::vector<double> values = sizes_of(value, points.size(), value_name);
    std::vector<Place> places;
    for (std::size_t k = 0; k < points.size(); ++k)
        places.push_back({points[k], values[k]});
    return places;
}

/// A mesh's points, and where it is made anew: a KeptPoints.
std::optional<sampling::PartialRenewal> renewal_of(nb::handle kept) {
    if (kept.is_none())
        return {};
    const std::vector<Vec3> at = points_of(attribute<Array>(kept, "points"), "kept points");
    const auto strata = static_cast<std::int64_t>(Stratum::corner) + 1;
    const std::vector<int> role = numbers_of(attribute<Array>(kept, "stratum"), at.size(), strata, "kept stratum");
    const std::vector<int> labels =
        numbers_of(attribute<Array>(kept, "label"), at.size(), std::numeric_limits<std::int32_t>::max(), "kept label");
    sampling::Cloud mesh;
    for (std::size_t i = 0; i < at.size(); ++i)
        mesh.add(at[i], static_cast<Stratum>(role[i]), labels[i], 0.0);
    return std::optional<sampling::PartialRenewal>(
        std::in_place, std::move(mesh),
        places_of<sampling::PartialRenewal::Zone>(attribute<Array>(kept, "at"), "at", attribute<Array>(kept, "radius"),
                                                  "radius"));
}

/// Facets of the surface that are given, with their points: a HeldFacets.
sampling::HeldFacets held_of(nb::handle held, const domain::SurfaceData &surface) {
    sampling::HeldFacets out;
    out.points = points_of(attribute<Array>(held, "points"), "held points");
    const std::size_t count = out.points.size();
    const auto strata = static_cast<std::int64_t>(Stratum::corner) + 1;
    for (const int role : numbers_of(attribute<Array>(held, "stratum"), count, strata, "held stratum"))
        out.role.push_back(static_cast<Stratum>(role));
    out.label =
        numbers_of(attribute<Array>(held, "label"), count, std::numeric_limits<std::int32_t>::max(), "held label");
    out.facets = cells_of<3>(attribute<Array>(held, "facets"), count, "held facets");
    out.patch = numbers_of(attribute<Array>(held, "patch"), out.facets.size(),
                           static_cast<std::int64_t>(surface.sides.size()), "held patch");
    out.edges = cells_of<2>(attribute<Array>(held, "edges"), count, "held edges");
    out.curves =
        numbers_of(attribute<Array>(held, "curves"), static_cast<std::int64_t>(surface.segments.size()), "held curves");
    return out;
}

/// A ResampleOptions, for a surface of so many points.
sampling::ResampleOptions options_of(nb::handle asked, std::size_t surface_points) {
    sampling::ResampleOptions options;
    options.sizing.gap = attribute<double>(asked, "gap");
    options.sizing.tolerance = attribute<double>(asked, "tolerance");
    if (!(options.sizing.tolerance > 0.0))
        throw std::invalid_argument("tolerance must be positive");
    if (!(options.sizing.gap > 0.0))
        throw std::invalid_argument("gap must be positive");
    if (const auto local = maybe<Array>(asked, "local_tolerance"))
        options.sizing.local = sizes_of(*local, surface_points, "local_tolerance");
    if (const auto most = maybe<Array>(asked, "surface_size"))
        options.sizing.most = sizes_of(*most, surface_points, "surface_size");
    options.sizing.limits = places_of<domain::SizeLimit>(attribute<Array>(asked, "finer_at"), "finer_at",
                                                         attribute<Array>(asked, "finer_size"), "finer_size");
    options.sizing.one_row = attribute<bool>(asked, "one_row");
    options.cosines = attribute<bool>(asked, "cosines");
    options.seed = attribute<std::uint64_t>(asked, "seed");
    return options;
}

nb::object resample(nb::handle on, nb::handle of, nb::handle asked, nb::handle kept, nb::handle holds,
                    const nb::object &progress, const nb::object &expected, unsigned threads) {
    trim();
    domain::SurfaceData surface = surface_of(on);
    const domain::InputMesh mesh = region_mesh_of(of);
    if (surface.triangles.empty() || mesh.tets.empty())
        throw std::invalid_argument("a surface and a mesh are needed");
    sampling::ResampleOptions options = options_of(asked, surface.points.size());
    const std::vector<double> wanted = wanted_of(maybe<Array>(asked, "size"), mesh);
    if (!expected.is_none())
        options.expected = [&](double tets) { return goes_on(expected, tets); };
    const std::optional<sampling::PartialRenewal> renewal = renewal_of(kept);
    const sampling::HeldFacets facets = holds.is_none() ? sampling::HeldFacets{} : held_of(holds, surface);
    const bool given = !holds.is_none();
    Monitor::Listener listener = [&](double done, std::int64_t bad) { return goes_on(progress, done, bad); };
    sampling::Resampled result;
    sampling::SurfaceLabels labels;
    std::vector<int> numbers;
    {
        nb::gil_scoped_release release;
        Monitor monitor(listener);
        domain::Reference reference(std::move(surface));
        std::optional<sampling::HeldSurface> held;
        if (given)
            held.emplace(facets, reference);
        result = sampling::resample(reference, mesh, wanted, options, renewal, held ? &*held : nullptr, monitor,
                                    workers_of(threads));
        if (!result.complex.all.tets.empty()) {
            sampling::free_buried(result.cloud, result.complex, reference);
            labels = sampling::label_surface(result.cloud, result.complex, reference, held ? &*held : nullptr);
            if (held)
                numbers = held->numbers(result.cloud);
        }
    }
    trim();
    return to_python(result, labels, numbers);
}

} // namespace

void bind_resample(nb::module_ &m) {
    m.def("resample", &resample, nb::arg("surface"), nb::arg("mesh"), nb::arg("options"), nb::kw_only(),
          nb::arg("kept") = nb::none(), nb::arg("held") = nb::none(), nb::arg("progress") = nb::none(),
          nb::arg("expected") = nb::none(), nb::arg("threads") = 0,
          nb::sig("def resample(surface: wct_plugin.core.domain.StratifiedSurface,"
                  " mesh: wct_plugin.core.domain.RegionMesh | wct_plugin.core.domain.StratifiedMesh,"
                  " options: wct_plugin.core.requests.ResampleOptions, *,"
                  " kept: wct_plugin.core.requests.KeptPoints | None = None,"
                  " held: wct_plugin.core.requests.HeldFacets | None = None,"
                  " progress: collections.abc.Callable[[float, int], typing.Any] | None = None,"
                  " expected: collections.abc.Callable[[float], typing.Any] | None = None,"
                  " threads: int = 0) -> wct_plugin.core.results.ResampleResult"),
          R"(Resample a domain with tets that are nearly all well-centered.

Parameters
----------
surface
    To stay near; with its sides and corners.
mesh
    Says what is inside.
options
    How.
kept
    Points of a mesh that stay, but for those near some places: it is made anew there, and what is beside moves.
held
    Facets and edges that are to be in the mesh, to the bit.
progress
    ``progress(done, bad)`` hears the done fraction and the number of tets that miss the goal; it returns something
    false other than None to stop.
expected
    ``expected(tets)`` hears about how many tets there will be, before any is made, but for a mesh made anew in places;
    it returns False to give up, without a tet.
threads
    At most so many work; 0: OMP_NUM_THREADS, or one per core. The bits are the same whatever it is.

Returns
-------
ResampleResult
    The label of a corner is its surface point. Points of the surface that are buried inside count as interior.
    No tets where it was stopped before there were any, or with ``one_row`` false where there is no layer for one. The
    same input and seed give the same bits.

Raises
------
ValueError
    Where an array has a wrong type, shape or index, or an option a value that is not allowed.)");
}

} // namespace wct::bindings
