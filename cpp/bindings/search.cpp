#include "bindings/bindings.h"
#include "bindings/domain.h"
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

/// What is left of a complex, numbered anew.
struct Compact {
    explicit Compact(const search::TetComplex &complex) : place(complex.vertex_slots(), -1) {
        for (std::size_t k = 0; k < complex.vertex_slots(); ++k)
            if (complex.used(static_cast<int>(k))) {
                place[k] = static_cast<int>(vertices.size());
                vertices.push_back(static_cast<int>(k));
            }
        for (std::size_t k = 0; k < complex.tet_slots(); ++k)
            if (complex.alive(static_cast<int>(k)))
                tets.push_back(static_cast<int>(k));
    }

    /// A cell with the new numbers.
    template <std::size_t corners> std::array<std::int32_t, corners> cell(std::array<std::int32_t, corners> of) const {
        for (auto &v : of)
            v = place[v];
        return of;
    }

    std::vector<int> vertices, tets;
    std::vector<int> place; // -1: not used
};

nb::object mesh_of(const search::TetComplex &complex, const Compact &compact) {
    std::vector<Vec3> points;
    std::vector<double> sizes;
    std::vector<std::int64_t> labels;
    std::vector<std::int8_t> strata;
    for (const int v : compact.vertices) {
        const search::Vertex &vertex = complex.vertex(v);
        points.push_back(vertex.position);
        strata.push_back(static_cast<std::int8_t>(vertex.stratum));
        labels.push_back(vertex.label);
        sizes.push_back(vertex.size);
    }
    std::vector<Tet> tets;
    std::vector<int> regions;
    for (const int t : compact.tets) {
        tets.push_back(compact.cell(complex.tet(t)));
        regions.push_back(complex.region(t));
    }
    std::vector<Facet> facets;
    std::vector<int> patches;
    for (const auto &[key, patch] : complex.sorted_surface()) {
        facets.push_back(compact.cell(key));
        patches.push_back(patch);
    }
    std::vector<std::pair<Edge, int>> curves(complex.creases().begin(), complex.creases().end());
    std::sort(curves.begin(), curves.end());
    std::vector<Edge> edges;
    std::vector<int> curve;
    for (const auto &[key, one] : curves) {
        edges.push_back(compact.cell(key));
        curve.push_back(one);
    }
    nb::dict out;
    out["points"] = array_of(points);
    out["tets"] = array_of<std::int64_t>(tets);
    out["regions"] = array_of<std::int64_t>(regions);
    out["stratum"] = array_of<std::int8_t>(strata);
    out["label"] = array_of<std::int64_t>(labels);
    out["size"] = array_of<double>(sizes);
    out["facets"] = array_of<std::int64_t>(facets);
    out["facet_patch"] = array_of<std::int64_t>(patches);
    out["creases"] = array_of<std::int64_t>(edges);
    out["crease_curve"] = array_of<std::int64_t>(curve);
    return made("wct_plugin.core.domain", "StratifiedMesh", out);
}

nb::object to_python(const search::TetComplex &complex, const search::SearchOutcome &outcome,
                     const std::vector<int> &released) {
    const Compact compact(complex);
    std::vector<std::int64_t> stuck;
    for (std::size_t row = 0; row < compact.tets.size(); ++row)
        if (std::binary_search(outcome.stuck.begin(), outcome.stuck.end(), compact.tets[row]))
            stuck.push_back(static_cast<std::int64_t>(row));
    nb::dict out;
    out["mesh"] = mesh_of(complex, compact);
    out["bad"] = outcome.bad;
    out["stuck"] = array_of<std::int64_t>(stuck);
    out["passes"] = outcome.passes;
    out["kicks"] = outcome.kicks;
    out["accepted"] = outcome.accepted;
    out["evaluations"] = outcome.evaluations;
    out["stopped"] = outcome.stopped;
    out["released"] = array_of<std::int64_t>(released);
    return made("wct_plugin.core.results", "SearchResult", out);
}

/// What names a piece of the surface does so, of those there are.
void expect_pieces(const StratifiedMesh &mesh, const domain::SurfaceData &on) {
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

/// A mask of `count` numbers, of those that an option lists.
std::vector<std::uint8_t> listed(nb::handle asked, const char *name, std::size_t count) {
    std::vector<std::uint8_t> mask(count, 0);
    if (const auto given = maybe<Array>(asked, name))
        for (const int k : numbers_of(*given, static_cast<std::int64_t>(count), name))
            mask[k] = 1;
    return mask;
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
    if (const auto most = maybe<long>(asked, "most_evaluations")) {
        if (*most < 0)
            refuse("most_evaluations is " + std::to_string(*most) + "; it may not be negative");
        options.evaluations = *most;
    }
    options.most = maybe<std::size_t>(asked, "most_tets").value_or(options.most);
    return options;
}

/// Facets that stay have points that do, and only of such a facet is it known that no tet at it can be good.
void expect_fixed(const StratifiedMesh &mesh, const search::SearchOptions &options, const std::vector<int> &ruled_out) {
    for (std::size_t k = 0; k < mesh.facets.size(); ++k)
        for (const int v : mesh.facets[k])
            if (options.fixed[mesh.facet_patch[k]] && !(mesh.stratum[v] == Stratum::corner && mesh.label[v] == -1))
                refuse("fixed holds patch " + std::to_string(mesh.facet_patch[k]) + ", and point " + std::to_string(v) +
                       " of it may move");
    if ((options.flip_surface || options.split_surface) &&
        std::any_of(ruled_out.begin(), ruled_out.end(), [&](int k) { return !options.fixed[mesh.facet_patch[k]]; }))
        refuse("ruled_out is for facets that stay: neither flips nor splits of the surface go with it");
}

search::TetComplex complex_of(const StratifiedMesh &mesh, const std::vector<int> &ruled_out) {
    search::TetComplex complex;
    const auto needle = search::needle_cosines(mesh.points, mesh.tets, mesh.region, mesh.creases);
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        const bool inside = mesh.stratum[v] == Stratum::interior;
        complex.add_vertex(
            {mesh.points[v], mesh.stratum[v], inside ? -1 : static_cast<int>(mesh.label[v]), mesh.size[v], needle[v]});
    }
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
        complex.add_tet(mesh.tets[t], mesh.region[t], 0.0);
    for (std::size_t k = 0; k < mesh.facets.size(); ++k) {
        const Facet &f = mesh.facets[k];
        complex.add_facet(search::sorted(f[0], f[1], f[2]), mesh.facet_patch[k]);
    }
    for (std::size_t k = 0; k < mesh.creases.size(); ++k)
        complex.add_crease(search::sorted(mesh.creases[k][0], mesh.creases[k][1]), mesh.crease_curve[k]);
    for (const int k : ruled_out) {
        const Facet &f = mesh.facets[k];
        complex.rule_out(search::sorted(f[0], f[1], f[2]));
    }
    return complex;
}

nb::object search_well_centered(nb::handle of, nb::handle surface, nb::handle asked, const nb::object &progress) {
    domain::SurfaceData on = surface_of(surface);
    const std::size_t patches = pieces(on.patch).size(), curves = pieces(on.curve).size();
    const StratifiedMesh mesh =
        stratified_mesh_of(of, static_cast<std::int64_t>(patches), static_cast<std::int64_t>(curves));
    expect_pieces(mesh, on);
    expect_conforming(mesh.points, mesh.tets, mesh.facets, mesh.creases);
    std::vector<int> hopeless;
    if (const auto given = maybe<Array>(asked, "ruled_out"))
        hopeless = numbers_of(*given, static_cast<std::int64_t>(mesh.facets.size()), "ruled_out");
    search::SearchOptions options = options_of(asked, patches, curves);
    expect_fixed(mesh, options, hopeless);
    const double tolerance = number<double>(asked, "tolerance", [](double t) { return t > 0.0; }, "must be positive");
    std::vector<double> local;
    if (const auto given = maybe<Array>(asked, "local_tolerance"))
        local = sizes_of(*given, on.points.size(), "local_tolerance");
    if (const auto given = maybe<Array>(asked, "volumes"))
        options.volumes = sizes_of(
            *given, static_cast<std::size_t>(*std::max_element(mesh.region.begin(), mesh.region.end())) + 1, "volumes");

    search::TetComplex complex = complex_of(mesh, hopeless);
    search::CreaseRelease search(
        complex,
        {on.points, on.triangles, on.patch, on.segments, on.curve, listed(asked, "loose", curves), on.flat, local},
        tolerance, 0.125 * mean_size(mesh.size, mesh.stratum));
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
    m.def("search_well_centered", &search_well_centered, nb::arg("mesh"), nb::arg("surface"), nb::arg("options"),
          nb::arg("progress") = nb::none(),
          nb::sig("def search_well_centered(mesh: wct_plugin.core.domain.StratifiedMesh,"
                  " surface: wct_plugin.core.domain.StratifiedSurface,"
                  " options: wct_plugin.core.requests.SearchOptions,"
                  " progress: collections.abc.Callable[[str, float, int], typing.Any] | None = None)"
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
