#include "bindings/bindings.h"
#include "bindings/domain.h"
#include "bindings/workers.h"
#include "search/crease_release.h"
#include "search/stratified_mesh.h"

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

nb::object to_python(const search::TetComplex &complex, const search::SearchOutcome &outcome,
                     const std::vector<int> &released) {
    nb::dict out;
    out["mesh"] = object_of(search::mesh_of(complex));
    out["bad"] = outcome.bad;
    out["stuck"] = array_of<std::int64_t>(search::rows_of(complex, outcome.stuck));
    out["beyond"] = complex.farthest_over();
    out["passes"] = outcome.passes;
    out["kicks"] = outcome.kicks;
    out["accepted"] = outcome.accepted;
    out["evaluations"] = outcome.evaluations;
    out["work"] = outcome.work;
    out["stopped"] = outcome.stopped;
    out["released"] = array_of<std::int64_t>(released);
    return made("wct_plugin.core.results", "SearchResult", out);
}

/// What names a piece of the surface does so, of those there are.
void expect_pieces(const search::StratifiedMesh &mesh, const domain::SurfaceData &on) {
    const std::vector<std::uint8_t> has_patch = pieces(on.patch), has_curve = pieces(on.curve);
    for (const int p : mesh.facet_patch)
        expect_piece(p, has_patch, "facet_patch");
    for (const int c : mesh.crease_curve)
        expect_piece(c, has_curve, "crease_curve");
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        const Stratum role = mesh.stratum[v];
        const std::int64_t label = mesh.label[v];
        const std::size_t count = role == Stratum::patch    ? has_patch.size()
                                  : role == Stratum::crease ? has_curve.size()
                                                            : on.points.size();
        const bool pinned = role == Stratum::corner && label == -1;
        if (role != Stratum::interior && !pinned && (label < 0 || label >= static_cast<std::int64_t>(count)))
            refuse("label of point " + std::to_string(v) + " is " + std::to_string(label) + "; there are " +
                   std::to_string(count) +
                   (role == Stratum::patch    ? " patches"
                    : role == Stratum::crease ? " curves"
                                              : " points of the surface"));
        if (role == Stratum::patch || role == Stratum::crease)
            expect_piece(label, role == Stratum::patch ? has_patch : has_curve, "label");
    }
}

/// A number of the options that must meet a condition.
template <class T> T number(nb::handle asked, const char *name, bool (*allowed)(T), const char *must) {
    const T value = attribute<T>(asked, name);
    if (!allowed(value))
        refuse(std::string(name) + " is " + std::to_string(value) + "; it " + must);
    return value;
}

/// A SearchOptions, for a surface of so many patches and curves.
search::SearchOptions options_of(nb::handle asked, std::size_t patches, std::size_t curves) {
    search::SearchOptions options;
    options.acute = attribute<bool>(asked, "acute");
    options.margin = number<double>(
        asked, "margin", [](double m) { return m >= 0.0 && m < 1.0 / 3.0; },
        "must lie in 0..1/3, the value of the regular tet");
    options.flip_surface = attribute<bool>(asked, "flip_surface");
    options.split_surface = attribute<bool>(asked, "split_surface");
    options.fixed = listed(asked, "fixed", patches);
    options.fixed_curves = listed(asked, "fixed_curves", curves);
    const double bend = number<double>(
        asked, "crease_angle", [](double a) { return a > 0.0 && a <= 180.0; }, "must lie in 0..180 degrees");
    options.crease = bend < 180.0 ? std::cos(bend / 180.0 * std::numbers::pi) : -1.0;
    const char *positive = "may not be negative";
    options.passes = number<int>(asked, "passes", [](int n) { return n >= 0; }, positive);
    options.kicks = number<long>(asked, "kicks", [](long n) { return n >= 0; }, positive);
    options.worth = number<double>(asked, "worth", [](double w) { return w >= 0.0; }, positive);
    options.seed = attribute<std::uint64_t>(asked, "seed");
    if (const auto most = maybe<long>(asked, "most_work")) {
        if (*most < 0)
            refuse("most_work is " + std::to_string(*most) + "; it may not be negative");
        options.work = *most;
    }
    options.most = maybe<std::size_t>(asked, "most_tets").value_or(options.most);
    return options;
}

/// Facets that stay have points that do, and only of such a facet is it known that no tet at it can be good.
void expect_fixed(const search::StratifiedMesh &mesh, const search::SearchOptions &options,
                  const std::vector<int> &ruled_out) {
    for (std::size_t k = 0; k < mesh.facets.size(); ++k)
        for (const int v : mesh.facets[k])
            if (options.fixed[mesh.facet_patch[k]] && !(mesh.stratum[v] == Stratum::corner && mesh.label[v] == -1))
                refuse("fixed holds patch " + std::to_string(mesh.facet_patch[k]) + ", and point " + std::to_string(v) +
                       " of it may move");
    if ((options.flip_surface || options.split_surface) &&
        std::any_of(ruled_out.begin(), ruled_out.end(), [&](int k) { return !options.fixed[mesh.facet_patch[k]]; }))
        refuse("ruled_out is for facets that stay: neither flips nor splits of the surface go with it");
}

nb::object search_well_centered(nb::handle of, nb::handle surface, nb::handle asked, const nb::object &progress,
                                unsigned threads) {
    domain::SurfaceData on = surface_of(surface);
    const std::size_t patches = pieces(on.patch).size(), curves = pieces(on.curve).size();
    const search::StratifiedMesh mesh = stratified_mesh_of(of, patches, curves);
    expect_pieces(mesh, on);
    search::expect_conforming(mesh);
    std::vector<int> hopeless;
    if (const auto given = maybe<Array>(asked, "ruled_out"))
        hopeless = numbers_of(*given, static_cast<std::int64_t>(mesh.facets.size()), "ruled_out");
    search::SearchOptions options = options_of(asked, patches, curves);
    options.workers = workers_of(threads);
    expect_fixed(mesh, options, hopeless);
    const double tolerance = number<double>(asked, "tolerance", [](double t) { return t > 0.0; }, "must be positive");
    std::vector<double> local;
    if (const auto given = maybe<Array>(asked, "local_tolerance"))
        local = sizes_of(*given, on.points.size(), "local_tolerance");
    if (const auto given = maybe<Array>(asked, "volumes"))
        options.volumes = sizes_of(
            *given, static_cast<std::size_t>(*std::max_element(mesh.region.begin(), mesh.region.end())) + 1, "volumes");

    search::TetComplex complex = search::complex_of(mesh);
    for (const int k : hopeless)
        complex.rule_out(sorted(mesh.facets[k][0], mesh.facets[k][1], mesh.facets[k][2]));
    search::CreaseRelease search(
        complex,
        {on.points, on.triangles, on.patch, on.segments, on.curve, listed(asked, "loose", curves), on.flat, local},
        tolerance, 0.125 * search::mean_surface_size(mesh));
    search::SearchOutcome outcome;
    {
        nb::gil_scoped_release release;
        outcome = search.run(
            options, [&](const char *phase, double done, int bad) { return goes_on(progress, phase, done, bad); });
    }
    search::expect_kept(complex);
    return to_python(complex, outcome, search.released());
}

} // namespace

void bind_search(nb::module_ &m) {
    m.def("search_well_centered", &search_well_centered, nb::arg("mesh"), nb::arg("surface"), nb::arg("options"),
          nb::arg("progress") = nb::none(), nb::arg("threads") = 0,
          nb::sig("def search_well_centered(mesh: wct_plugin.core.domain.StratifiedMesh,"
                  " surface: wct_plugin.core.domain.StratifiedSurface,"
                  " options: wct_plugin.core.requests.SearchOptions,"
                  " progress: collections.abc.Callable[[str, float, int], typing.Any] | None = None,"
                  " threads: int = 0)"
                  " -> wct_plugin.core.results.SearchResult"),
          R"(Reconnect and move by local search until all tets contain their circumcenter, and facets are acute.

Facets and surface stay within the tolerance of each other, or come nearer where they were farther apart. Planar patches
and straight creases are kept exactly, unless they are smaller than 28 tolerances and 3 % of the surface's diagonal, and
corners at them; other corners move by up to half the tolerance.

Parameters
----------
mesh
    Whose facets are the boundary and whatever lies on a patch inside.
surface
    To stay near. Its sides and corners do not matter.
options
    How. Rows that are ruled out go only with a surface that is neither flipped nor split, or with fixed patches. Of the
    loose curves, those that are not kept exactly, nor bound a planar patch that is, become ordinary surface where tets
    near them withstand an eighth of the kicks. Volumes are reached as far as tets and tolerance allow; planar patches
    with curved rims keep their area so too.
progress
    ``progress(phase, done, bad)`` hears the done fraction of the phase and the number of tets that miss the goal; it
    returns something false other than None to stop.
threads
    To work on; 0 as many as OMP_NUM_THREADS says, or there are cores. The same bits come out whatever it is.

Returns
-------
SearchResult
    The same input and seed give the same bits.

Raises
------
ValueError
    Where an array has a wrong type, shape or index, an option a value that is not allowed, a tet is inverted or flat,
    or a facet is none of a tet.)");
}

} // namespace wct::bindings
