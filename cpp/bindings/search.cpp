#include "bindings/arrays.h"
#include "bindings/bindings.h"
#include "geometry/predicates.h"
#include "search/crease_release.h"
#include "search/needle_cosines.h"

#include <nanobind/stl/optional.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

namespace nb = nanobind;

namespace wct::bindings {

namespace {

/// Which numbers name a piece of the surface: some may be left out.
std::vector<std::uint8_t> pieces(const std::vector<int> &labels) {
    std::vector<std::uint8_t> there(labels.empty() ? 0 : *std::max_element(labels.begin(), labels.end()) + 1, 0);
    for (const int label : labels)
        there[label] = 1;
    return there;
}

/// A label names one of the pieces.
void expect_piece(std::int64_t label, const std::vector<std::uint8_t> &pieces, const char *name) {
    if (!pieces[static_cast<std::size_t>(label)])
        refuse(std::string(name) + " holds " + std::to_string(label) + ", of which the surface has no piece");
}

template <std::size_t n> std::string text(const std::array<int, n> &cell) {
    std::string out = "(";
    for (std::size_t k = 0; k < n; ++k)
        out += (k ? ", " : "") + std::to_string(cell[k]);
    return out + ")";
}

/// The tets are positive and conform; the facets are theirs, every boundary facet among them; so are the creases.
void expect_conforming(const std::vector<Vec3> &points, const std::vector<Tet> &tets, const std::vector<Facet> &facets,
                       const std::vector<Edge> &creases) {
    std::unordered_map<Facet, int, search::KeyHash> uses;
    std::unordered_set<Edge, search::KeyHash> edges;
    for (std::size_t t = 0; t < tets.size(); ++t) {
        const Tet &tet = tets[t];
        if (geometry::orient3d(points[tet[0]], points[tet[1]], points[tet[2]], points[tet[3]]) <= 0)
            refuse("tet " + std::to_string(t) + " is inverted or flat");
        for (int i = 0; i < 4; ++i) {
            const Facet key = search::sorted(tet[(i + 1) % 4], tet[(i + 2) % 4], tet[(i + 3) % 4]);
            if (++uses[key] > 2)
                refuse("tets: facet " + text(key) + " belongs to more than two");
            for (int k = 0; k < i; ++k)
                edges.insert(search::sorted(tet[i], tet[k]));
        }
    }
    std::unordered_set<Facet, search::KeyHash> given;
    for (const Facet &facet : facets) {
        const Facet key = search::sorted(facet[0], facet[1], facet[2]);
        if (!uses.contains(key))
            refuse("facets: " + text(facet) + " is no facet of a tet");
        given.insert(key);
    }
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (int i = 0; i < 4; ++i) {
            const Facet key = search::sorted(tets[t][(i + 1) % 4], tets[t][(i + 2) % 4], tets[t][(i + 3) % 4]);
            if (uses[key] == 1 && !given.contains(key))
                refuse("facets: boundary facet " + text(key) + " is missing");
        }
    for (const Edge &crease : creases)
        if (!edges.contains(search::sorted(crease[0], crease[1])))
            refuse("creases: " + text(crease) + " is no edge of a tet");
}

/// Every surface facet is a facet of a tet and every crease an edge of one. The operators keep it so: if not, the fault
/// is theirs, and what is lost is not to be lost silently.
void expect_kept(const search::TetComplex &complex) {
    const auto of_a_tet = [&](const auto &cell) {
        const auto &star = complex.star(cell[0]);
        return std::any_of(star.begin(), star.end(), [&](int t) {
            return std::all_of(cell.begin(), cell.end(), [&](int v) { return complex.has(t, v); });
        });
    };
    for (const auto &[facet, patch] : complex.sorted_surface())
        if (!of_a_tet(facet))
            throw std::logic_error("the search lost facet " + text(facet) + " of patch " + std::to_string(patch));
    for (const auto &[edge, curve] : complex.creases())
        if (!of_a_tet(edge))
            throw std::logic_error("the search lost edge " + text(edge) + " of curve " + std::to_string(curve));
}

/// Of the surface's points: how far apart its vertices will be.
double mean_size(const std::vector<double> &size, const std::vector<Stratum> &stratum) {
    double sum = 0.0, count = 0.0;
    for (std::size_t v = 0; v < size.size(); ++v)
        if (stratum[v] != Stratum::interior) {
            sum += size[v];
            count += 1.0;
        }
    return count > 0.0 ? sum / count : 1.0;
}

nb::dict to_python(const search::TetComplex &complex, const search::SearchOutcome &outcome,
                   const std::vector<int> &released) {
    std::vector<int> place(complex.vertex_slots(), -1);
    std::vector<double> out_points, out_sizes;
    std::vector<std::int64_t> out_tets, out_regions, out_labels, out_facets, out_patches, out_creases, out_curves;
    std::vector<std::int64_t> out_stuck;
    std::vector<std::int8_t> out_strata;
    for (std::size_t k = 0; k < complex.vertex_slots(); ++k) {
        const int v = static_cast<int>(k);
        if (!complex.used(v))
            continue;
        place[v] = static_cast<int>(out_strata.size());
        const search::Vertex &vertex = complex.vertex(v);
        out_points.insert(out_points.end(), {vertex.position.x, vertex.position.y, vertex.position.z});
        out_strata.push_back(static_cast<std::int8_t>(vertex.stratum));
        out_labels.push_back(vertex.label);
        out_sizes.push_back(vertex.size);
    }
    for (std::size_t k = 0; k < complex.tet_slots(); ++k) {
        const int t = static_cast<int>(k);
        if (!complex.alive(t))
            continue;
        if (std::binary_search(outcome.stuck.begin(), outcome.stuck.end(), t))
            out_stuck.push_back(static_cast<std::int64_t>(out_regions.size()));
        for (int v : complex.tet(t))
            out_tets.push_back(place[v]);
        out_regions.push_back(complex.region(t));
    }
    for (const auto &[key, patch] : complex.sorted_surface()) {
        for (int v : key)
            out_facets.push_back(place[v]);
        out_patches.push_back(patch);
    }
    std::vector<std::pair<Edge, int>> curves(complex.creases().begin(), complex.creases().end());
    std::sort(curves.begin(), curves.end());
    for (const auto &[key, curve] : curves) {
        for (int v : key)
            out_creases.push_back(place[v]);
        out_curves.push_back(curve);
    }
    nb::dict result;
    result["points"] = array_of<double>(out_points, 3);
    result["tets"] = array_of<std::int64_t>(out_tets, 4);
    result["regions"] = array_of<std::int64_t>(out_regions);
    result["stratum"] = array_of<std::int8_t>(out_strata);
    result["label"] = array_of<std::int64_t>(out_labels);
    result["size"] = array_of<double>(out_sizes);
    result["facets"] = array_of<std::int64_t>(out_facets, 3);
    result["facet_patch"] = array_of<std::int64_t>(out_patches);
    result["creases"] = array_of<std::int64_t>(out_creases, 2);
    result["crease_curve"] = array_of<std::int64_t>(out_curves);
    result["bad"] = outcome.bad;
    result["stuck"] = array_of<std::int64_t>(out_stuck);
    result["passes"] = outcome.passes;
    result["kicks"] = outcome.kicks;
    result["accepted"] = outcome.accepted;
    result["evaluations"] = outcome.evaluations;
    result["stopped"] = outcome.stopped;
    result["released"] = array_of<std::int64_t>(std::vector<std::int64_t>(released.begin(), released.end()));
    return result;
}

nb::dict search_well_centered(const Array &points, const Array &tets, const Array &regions, const Array &stratum,
                              const Array &label, const Array &size, const Array &facets, const Array &facet_patch,
                              const Array &creases, const Array &crease_curve, const Array &surface_points,
                              const Array &surface_triangles, const Array &surface_patch, const Array &surface_segments,
                              const Array &surface_curve, double tolerance, bool acute, double margin,
                              bool flip_surface, bool split_surface, int passes, long kicks, std::uint64_t seed,
                              const nb::object &progress, const std::optional<Array> &ruled_out,
                              const std::optional<Array> &fixed, const std::optional<Array> &fixed_curves,
                              const std::optional<Array> &loose, double worth, double flat,
                              const std::optional<Array> &volumes, const std::optional<std::size_t> &most_tets,
                              const std::optional<Array> &local_tolerance, const std::optional<long> &most_evaluations,
                              double crease_angle) {
    const auto on = points_of(surface_points, "surface_points");
    const auto triangles = cells_of<3>(surface_triangles, on.size(), "surface_triangles");
    const auto patch =
        numbers_of(surface_patch, triangles.size(), static_cast<std::int64_t>(triangles.size()), "surface_patch");
    const auto segments = cells_of<2>(surface_segments, on.size(), "surface_segments");
    const auto curve = curves_of(surface_curve, segments.size(), triangles.size(), "surface_curve");
    const std::vector<std::uint8_t> has_patch = pieces(patch), has_curve = pieces(curve);
    const auto patches = static_cast<std::int64_t>(has_patch.size());
    const auto curves = static_cast<std::int64_t>(has_curve.size());

    const auto at = points_of(points);
    const auto cells = cells_of<4>(tets, at.size(), "tets");
    const auto region = numbers_of(regions, cells.size(), std::numeric_limits<int>::max(), "regions");
    const auto role = strata_of(stratum, at.size());
    const auto owner = labels_of(label, at.size(), "label");
    const auto wanted = sizes_of(size, at.size(), "size");
    const auto sheet = cells_of<3>(facets, at.size(), "facets");
    const auto sheet_patch = numbers_of(facet_patch, sheet.size(), patches, "facet_patch");
    for (const int p : sheet_patch)
        expect_piece(p, has_patch, "facet_patch");
    const auto edges = cells_of<2>(creases, at.size(), "creases");
    const auto edge_curve = numbers_of(crease_curve, edges.size(), curves, "crease_curve");
    for (const int c : edge_curve)
        expect_piece(c, has_curve, "crease_curve");
    for (std::size_t v = 0; v < at.size(); ++v) {
        const std::int64_t count = role[v] == Stratum::patch    ? patches
                                   : role[v] == Stratum::crease ? curves
                                                                : static_cast<std::int64_t>(on.size());
        const bool pinned = role[v] == Stratum::corner && owner[v] == -1;
        if (role[v] != Stratum::interior && !pinned && (owner[v] < 0 || owner[v] >= count))
            refuse("label of point " + std::to_string(v) + " is " + std::to_string(owner[v]) + "; there are " +
                   std::to_string(count) +
                   (role[v] == Stratum::patch    ? " patches"
                    : role[v] == Stratum::crease ? " curves"
                                                 : " surface_points"));
        if (role[v] == Stratum::patch || role[v] == Stratum::crease)
            expect_piece(owner[v], role[v] == Stratum::patch ? has_patch : has_curve, "label");
    }
    expect_conforming(at, cells, sheet, edges);
    std::vector<int> hopeless;
    if (ruled_out)
        hopeless = numbers_of(*ruled_out, static_cast<std::int64_t>(sheet.size()), "ruled_out");
    std::vector<std::uint8_t> stays(static_cast<std::size_t>(patches), 0);
    if (fixed)
        for (const int p : numbers_of(*fixed, patches, "fixed"))
            stays[p] = 1;
    for (std::size_t k = 0; k < sheet.size(); ++k)
        for (const int v : sheet[k])
            if (stays[sheet_patch[k]] && !(role[v] == Stratum::corner && owner[v] == -1))
                refuse("fixed holds patch " + std::to_string(sheet_patch[k]) + ", and point " + std::to_string(v) +
                       " of it may move");
    if ((flip_surface || split_surface) &&
        std::any_of(hopeless.begin(), hopeless.end(), [&](int k) { return !stays[sheet_patch[k]]; }))
        refuse("ruled_out is for facets that stay: neither flips nor splits of the surface go with it");
    std::vector<std::uint8_t> curve_stays(static_cast<std::size_t>(curves), 0);
    if (fixed_curves)
        for (const int c : numbers_of(*fixed_curves, curves, "fixed_curves"))
            curve_stays[c] = 1;
    std::vector<std::uint8_t> may_go(static_cast<std::size_t>(curves), 0);
    if (loose)
        for (const int c : numbers_of(*loose, curves, "loose"))
            may_go[c] = 1;
    if (!(tolerance > 0.0))
        refuse("tolerance is " + std::to_string(tolerance) + "; it must be positive");
    if (!(margin >= 0.0 && margin < 1.0 / 3.0))
        refuse("margin is " + std::to_string(margin) + "; it must lie in 0..1/3, the value of the regular tet");
    if (passes < 0 || kicks < 0)
        refuse("passes is " + std::to_string(passes) + " and kicks is " + std::to_string(kicks) +
               "; neither may be negative");

    if (!(flat >= 0.0))
        refuse("flat is " + std::to_string(flat) + "; it may not be negative");
    if (most_evaluations && *most_evaluations < 0)
        refuse("most_evaluations is " + std::to_string(*most_evaluations) + "; it may not be negative");
    if (!(crease_angle > 0.0 && crease_angle <= 180.0))
        refuse("crease_angle is " + std::to_string(crease_angle) + "; it must lie in 0..180 degrees");
    if (!(worth >= 0.0))
        refuse("worth is " + std::to_string(worth) + "; it may not be negative");

    const std::vector<double> local =
        local_tolerance ? sizes_of(*local_tolerance, on.size(), "local_tolerance") : std::vector<double>{};

    search::TetComplex complex;
    const auto needle = search::needle_cosines(at, cells, region, edges);
    for (std::size_t v = 0; v < at.size(); ++v) {
        const bool inside = role[v] == Stratum::interior;
        complex.add_vertex({at[v], role[v], inside ? -1 : static_cast<int>(owner[v]), wanted[v], needle[v]});
    }
    for (std::size_t t = 0; t < cells.size(); ++t)
        complex.add_tet(cells[t], region[t], 0.0);
    for (std::size_t k = 0; k < sheet.size(); ++k)
        complex.add_facet(search::sorted(sheet[k][0], sheet[k][1], sheet[k][2]), sheet_patch[k]);
    for (std::size_t k = 0; k < edges.size(); ++k)
        complex.add_crease(search::sorted(edges[k][0], edges[k][1]), edge_curve[k]);

    for (const int k : hopeless)
        complex.rule_out(search::sorted(sheet[k][0], sheet[k][1], sheet[k][2]));

    search::SearchOptions options;
    options.acute = acute;
    options.margin = margin;
    options.flip_surface = flip_surface;
    options.split_surface = split_surface;
    options.fixed = stays;
    options.fixed_curves = curve_stays;
    options.crease = crease_angle < 180.0 ? std::cos(crease_angle / 180.0 * std::numbers::pi) : -1.0;
    options.passes = passes;
    options.kicks = kicks;
    options.seed = seed;
    options.worth = worth;
    options.evaluations = most_evaluations.value_or(options.evaluations);
    options.most = most_tets.value_or(options.most);
    if (volumes)
        options.volumes = sizes_of(
            *volumes, static_cast<std::size_t>(*std::max_element(region.begin(), region.end())) + 1, "volumes");
    search::CreaseRelease search(complex, {on, triangles, patch, segments, curve, may_go, flat, local}, tolerance,
                                 0.125 * mean_size(wanted, role));
    search::SearchOutcome outcome;
    {
        nb::gil_scoped_release release;
        outcome = search.run(
            options, [&](const char *phase, double done, int bad) { return goes_on(progress, phase, done, bad); });
    }
    expect_kept(complex);
    return to_python(complex, outcome, search.released());
}

} // namespace

void bind_search(nb::module_ &m) {
    m.def("search_well_centered", &search_well_centered, nb::arg("points"), nb::arg("tets"), nb::arg("regions"),
          nb::arg("stratum"), nb::arg("label"), nb::arg("size"), nb::arg("facets"), nb::arg("facet_patch"),
          nb::arg("creases"), nb::arg("crease_curve"), nb::arg("surface_points"), nb::arg("surface_triangles"),
          nb::arg("surface_patch"), nb::arg("surface_segments"), nb::arg("surface_curve"), nb::kw_only(),
          nb::arg("tolerance"), nb::arg("acute"), nb::arg("margin"), nb::arg("flip_surface"), nb::arg("split_surface"),
          nb::arg("passes"), nb::arg("kicks"), nb::arg("seed"), nb::arg("progress") = nb::none(),
          nb::arg("ruled_out") = nb::none(), nb::arg("fixed") = nb::none(), nb::arg("fixed_curves") = nb::none(),
          nb::arg("loose") = nb::none(), nb::arg("worth") = std::numeric_limits<double>::infinity(),
          nb::arg("flat") = 0.0, nb::arg("volumes") = nb::none(), nb::arg("most_tets") = nb::none(),
          nb::arg("local_tolerance") = nb::none(), nb::arg("most_evaluations") = nb::none(),
          nb::arg("crease_angle") = 180.0);
}

} // namespace wct::bindings
