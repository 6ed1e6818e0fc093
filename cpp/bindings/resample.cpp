#include "bindings/bindings.h"
#include "bindings/domain.h"
#include "bindings/workers.h"

#include "sampling/resample.h"
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

nb::dict to_python(const sampling::Resampled &result, const sampling::SurfaceLabels &surface,
                   const std::vector<int> &held) {
    const sampling::Cloud &cloud = result.cloud;
    std::vector<int> kept; // the tets inside
    for (std::size_t t = 0; t < result.complex.all.tets.size(); ++t)
        if (result.complex.region[t] >= 0)
            kept.push_back(static_cast<int>(t));
    std::vector<char> used(cloud.count(), 0);
    for (const int t : kept)
        for (const int v : result.complex.all.tets[t])
            used[v] = 1;
    std::vector<std::size_t> points;
    std::vector<std::int64_t> place(cloud.count(), -1);
    for (std::size_t i = 0; i < cloud.count(); ++i)
        if (used[i]) {
            place[i] = static_cast<std::int64_t>(points.size());
            points.push_back(i);
        }
    nb::dict out;
    out["points"] = array<double>(points.size(), 3, [&](double *to) {
        for (const std::size_t i : points) {
            *to++ = cloud.points[i].x;
            *to++ = cloud.points[i].y;
            *to++ = cloud.points[i].z;
        }
    });
    out["tets"] = array<std::int64_t>(kept.size(), 4, [&](std::int64_t *to) {
        for (const int t : kept)
            for (const int v : result.complex.all.tets[t])
                *to++ = place[v];
    });
    out["region"] = array<std::int64_t>(kept.size(), 0, [&](std::int64_t *to) {
        for (const int t : kept)
            *to++ = result.complex.region[t];
    });
    out["stratum"] = array<std::int8_t>(points.size(), 0, [&](std::int8_t *to) {
        for (const std::size_t i : points)
            *to++ = static_cast<std::int8_t>(cloud.role[i]);
    });
    out["label"] = array<std::int64_t>(points.size(), 0, [&](std::int64_t *to) {
        for (const std::size_t i : points)
            *to++ = cloud.role[i] == Stratum::interior ? -1 : cloud.label[i];
    });
    out["size"] = array<double>(points.size(), 0, [&](double *to) {
        for (const std::size_t i : points)
            *to++ = cloud.size[i];
    });
    out["facets"] = array<std::int64_t>(surface.facets.size(), 3, [&](std::int64_t *to) {
        for (const Facet &facet : surface.facets)
            for (const int v : facet)
                *to++ = place[v];
    });
    out["facet_patch"] = array_of<std::int64_t>(surface.patch);
    out["creases"] = array<std::int64_t>(surface.creases.size(), 2, [&](std::int64_t *to) {
        for (const Edge &edge : surface.creases)
            for (const int v : edge)
                *to++ = place[v];
    });
    out["crease_curve"] = array_of<std::int64_t>(surface.curve);
    const auto flawed = [&](const std::vector<int> &list) {
        return array<std::int64_t>(list.size(), 0, [&](std::int64_t *to) {
            for (const int v : list)
                *to++ = place[v];
        });
    };
    out["held"] = array<std::int64_t>(points.size(), 0, [&](std::int64_t *to) {
        for (const std::size_t i : points)
            *to++ = held.empty() ? -1 : held[i];
    });
    out["exposed"] = flawed(result.flaws.exposed);
    out["pinched"] = flawed(result.flaws.pinched);
    out["lost"] = flawed(result.lost);
    out["intact"] = result.intact;
    nb::dict stats;
    stats["bad"] = result.tally.bad;
    stats["deviation_out"] = result.deviation.most_out;
    stats["deviation_in"] = result.deviation.most_in;
    stats["volume_gain"] = result.deviation.volume_gain;
    stats["stopped"] = result.stopped;
    for (const auto &[name, value] : result.stats)
        stats[name.c_str()] = value;
    out["stats"] = stats;
    return out;
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

/// Places where edges are to be shorter.
std::vector<domain::SizeLimit> limits_of(const std::optional<Array> &at, const std::optional<Array> &size) {
    if (at.has_value() != size.has_value())
        refuse("finer_at and finer_size go together");
    if (!at)
        return {};
    return places_of<domain::SizeLimit>(*at, "finer_at", *size, "finer_size");
}

/// A mesh's points, and where it is made anew.
std::optional<sampling::PartialRenewal>
renewal_of(const std::optional<Array> &points, const std::optional<Array> &stratum, const std::optional<Array> &label,
           const std::optional<Array> &anew_at, const std::optional<Array> &anew_radius) {
    if (!points && !stratum && !label && !anew_at && !anew_radius)
        return {};
    if (!points || !stratum || !label || !anew_at || !anew_radius)
        refuse("kept_points, kept_stratum, kept_label, anew_at and anew_radius go together");
    const std::vector<Vec3> at = points_of(*points, "kept_points");
    const auto strata = static_cast<std::int64_t>(Stratum::corner) + 1;
    const std::vector<int> role = numbers_of(*stratum, at.size(), strata, "kept_stratum");
    const std::vector<int> labels =
        numbers_of(*label, at.size(), std::numeric_limits<std::int32_t>::max(), "kept_label");
    sampling::Cloud mesh;
    for (std::size_t i = 0; i < at.size(); ++i)
        mesh.add(at[i], static_cast<Stratum>(role[i]), labels[i], 0.0);
    return std::optional<sampling::PartialRenewal>(
        std::in_place, std::move(mesh),
        places_of<sampling::PartialRenewal::Zone>(*anew_at, "anew_at", *anew_radius, "anew_radius"));
}

/// Facets of the surface that are given, with their points.
sampling::HeldFacets held_of(const Array &points, const Array &stratum, const Array &label, const Array &facets,
                             const Array &facet_patch, const Array &edges, const Array &curves,
                             const domain::SurfaceData &surface) {
    sampling::HeldFacets held;
    held.points = points_of(points, "held_points");
    const auto strata = static_cast<std::int64_t>(Stratum::corner) + 1;
    for (const int role : numbers_of(stratum, held.points.size(), strata, "held_stratum"))
        held.role.push_back(static_cast<Stratum>(role));
    held.label = numbers_of(label, held.points.size(), std::numeric_limits<std::int32_t>::max(), "held_label");
    held.facets = cells_of<3>(facets, held.points.size(), "held_facets");
    held.patch =
        numbers_of(facet_patch, held.facets.size(), static_cast<std::int64_t>(surface.sides.size()), "held_patch");
    held.edges = cells_of<2>(edges, held.points.size(), "held_edges");
    held.curves = numbers_of(curves, static_cast<std::int64_t>(surface.segments.size()), "held_curves");
    return held;
}

nb::dict resample_arrays(const Array &surface_points, const Array &triangles, const Array &patch, const Array &segments,
                         const Array &curve, const Array &corners, const Array &sides, const Array &points,
                         const Array &tets, const Array &region, double tolerance, const std::optional<Array> &size,
                         const std::optional<Array> &folds, const std::optional<Array> &finer_at,
                         const std::optional<Array> &finer_size, const std::optional<Array> &kept_points,
                         const std::optional<Array> &kept_stratum, const std::optional<Array> &kept_label,
                         const std::optional<Array> &anew_at, const std::optional<Array> &anew_radius,
                         const std::optional<Array> &held_points, const std::optional<Array> &held_stratum,
                         const std::optional<Array> &held_label, const std::optional<Array> &held_facets,
                         const std::optional<Array> &held_patch, const std::optional<Array> &held_edges,
                         const std::optional<Array> &held_curves, bool cosines, std::uint64_t seed,
                         const nb::object &progress, double gap, double flat, const nb::object &expected,
                         unsigned threads, const std::optional<Array> &local, const std::optional<Array> &most) {
    trim();
    domain::SurfaceData surface =
        surface_of(points_of(surface_points, "surface_points"), triangles, "triangles", patch, "patch", sides);
    surface.segments = cells_of<2>(segments, surface.points.size(), "segments");
    surface.curve = curves_of(curve, surface.segments.size(), surface.triangles.size(), "curve");
    surface.corners = numbers_of(corners, static_cast<std::int64_t>(surface.points.size()), "corners");
    if (folds)
        surface.folds = cells_of<2>(*folds, surface.points.size(), "folds");
    const domain::InputMesh mesh = mesh_of(points, tets, region);
    if (surface.triangles.empty() || mesh.tets.empty())
        throw std::invalid_argument("a surface and a mesh are needed");
    if (!(tolerance > 0.0))
        throw std::invalid_argument("tolerance must be positive");
    if (!(gap > 0.0))
        throw std::invalid_argument("gap must be positive");
    if (!(flat >= 0.0))
        throw std::invalid_argument("flat may not be negative");
    surface.flat = flat;
    const std::vector<double> wanted = wanted_of(size, mesh);
    sampling::ResampleOptions options;
    options.sizing.gap = gap;
    options.sizing.tolerance = tolerance;
    if (local)
        options.sizing.local = sizes_of(*local, surface.points.size(), "local_tolerance");
    if (most)
        options.sizing.most = sizes_of(*most, surface.points.size(), "surface_size");
    options.sizing.limits = limits_of(finer_at, finer_size);
    options.cosines = cosines;
    options.seed = seed;
    if (!expected.is_none())
        options.expected = [&](double tets) { return goes_on(expected, tets); };
    const std::optional<sampling::PartialRenewal> renewal =
        renewal_of(kept_points, kept_stratum, kept_label, anew_at, anew_radius);
    const std::optional<Array> *of_held[] = {&held_points, &held_stratum, &held_label, &held_facets,
                                             &held_patch,  &held_edges,   &held_curves};
    const auto given = static_cast<std::size_t>(
        std::count_if(std::begin(of_held), std::end(of_held), [](auto *one) { return one->has_value(); }));
    if (given != 0 && given != std::size(of_held))
        refuse(
            "held_points, held_stratum, held_label, held_facets, held_patch, held_edges and held_curves go together");
    const sampling::HeldFacets facets = given ? held_of(*held_points, *held_stratum, *held_label, *held_facets,
                                                        *held_patch, *held_edges, *held_curves, surface)
                                              : sampling::HeldFacets{};
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
    m.def(
        "resample", &resample_arrays, nb::arg("surface_points"), nb::arg("triangles"), nb::arg("patch"),
        nb::arg("segments"), nb::arg("curve"), nb::arg("corners"), nb::arg("sides"), nb::arg("points"), nb::arg("tets"),
        nb::arg("region"), nb::arg("tolerance"), nb::arg("size") = nb::none(), nb::arg("folds") = nb::none(),
        nb::arg("finer_at") = nb::none(), nb::arg("finer_size") = nb::none(), nb::arg("kept_points") = nb::none(),
        nb::arg("kept_stratum") = nb::none(), nb::arg("kept_label") = nb::none(), nb::arg("anew_at") = nb::none(),
        nb::arg("anew_radius") = nb::none(), nb::arg("held_points") = nb::none(), nb::arg("held_stratum") = nb::none(),
        nb::arg("held_label") = nb::none(), nb::arg("held_facets") = nb::none(), nb::arg("held_patch") = nb::none(),
        nb::arg("held_edges") = nb::none(), nb::arg("held_curves") = nb::none(), nb::arg("cosines") = true,
        nb::arg("seed") = 1, nb::arg("progress") = nb::none(), nb::arg("gap") = domain::SizingForm{}.gap,
        nb::arg("flat") = 0.0, nb::arg("expected") = nb::none(), nb::arg("threads") = 0,
        nb::arg("local_tolerance") = nb::none(), nb::arg("surface_size") = nb::none(),
        "Resample a domain with tets that are nearly all well-centered.\n\n"
        "The surface: surface_points (n, 3), triangles (t, 3), patch (t,), crease segments (s, 2) with their curve "
        "ids\n"
        "(s,), corners (c,), sides (patches, 2): the region behind a patch's triangles and the one before, -1 "
        "outside.\n"
        "The mesh that says what is inside: points, tets, region per tet >= 0. tolerance: greatest distance between\n"
        "mesh and surface, in the mesh's unit. local_tolerance: the same per\n"
        "surface point, where it is less in places. size: wanted edge length per mesh point, default the mesh's own "
        "local\n"
        "one. surface_size: longest edges wanted per surface point.\n"
        "folds (f, 2): edges of the surface that bend as creases do and are none. finer_at (k, 3), finer_size "
        "(k,): edges are no longer than this round these places.\n"
        "kept_points (k, 3), kept_stratum, kept_label (k,): a mesh's points, with the patch, curve, surface point or,\n"
        "inside, region of each, that stay but for within anew_radius (z,) of anew_at (z, 3). held_points, "
        "held_stratum,\n"
        "held_label (h,) in the same way, held_facets (g, 3) between them, running as the surface's triangles do, and\n"
        "held_patch (g,): the facets of some patches, all of them, that are to be there; held_edges (e, 2) in the same "
        "way\n"
        "of held_curves (c,). progress(done, bad) "
        "returns False to stop. gap: how long edges beside a gap outside may be, in widths\n"
        "of the gap. flat: as far off a plane or line vertices may be where they count as on it, if that is more than "
        "1e-9 of its extent. expected(tets) hears about how many tets there will be, before any is made, but for a "
        "mesh made\n"
        "anew in places; it returns False to give up, without a tet.\n\n"
        "Returns a dict: points, tets, region per tet, per point stratum (0 interior, as are points of the surface\n"
        "buried there, 1 patch, 2 crease, 3 corner),\n"
        "label (patch or curve id, surface point of a corner, -1 inside), size and held, the held point that it is or "
        "-1;\n"
        "exposed and pinched, the points "
        "where\n"
        "the result is no manifold (both empty if all went well); intact: none such but at corners, no facet cuts\n"
        "across from one planar patch to another, the creases of those have no gaps, and the Euler characteristic of\n"
        "every region is as in the mesh, and all held facets are there; lost: points where the domain is not "
        "represented, but for corners;\n"
        "stats. No tets where it was stopped before there were any. The same input and seed give the same bits.");
}

} // namespace wct::bindings
