#include "library/well_center.h"

#include "geometry/euler_characteristic.h"
#include "library/local_search.h"
#include "library/surface_lengths.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <unordered_map>

namespace wct {

namespace library {

namespace {

/// Tolerance where none is given, as a fraction of the diagonal, unless the surface's own facets are coarser; and the
/// largest.
constexpr double kTolerance = 1e-3, kLargestTolerance = 0.1;

void expect(bool holds, const char *name, double value, const char *allowed) {
    if (!holds)
        throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) + "; allowed is " + allowed);
}

void expect_angle(double crease_angle) {
    expect(crease_angle > 0.0 && crease_angle < 180.0, "crease_angle", crease_angle, "above 0, below 180 degrees");
}

void expect_options(const WellCenterOptions &options) {
    expect_angle(options.crease_angle);
    if (options.tolerance)
        expect(*options.tolerance > 0.0 && *options.tolerance <= kLargestTolerance, "tolerance", *options.tolerance,
               "above 0, at most 0.1");
    if (options.edge_length)
        expect(*options.edge_length > 0.0 && std::isfinite(*options.edge_length), "edge_length", *options.edge_length,
               "a finite length above 0");
    expect(options.margin >= 0.0 && options.margin <= 0.1, "margin", options.margin, "0 to 0.1");
    expect(options.effort >= 1 && options.effort <= 100, "effort", options.effort, "1 to 100");
    if (options.max_tets)
        expect(*options.max_tets >= 1, "max_tets", 0.0, "at least 1");
}

/// The surface in the caller's numbers. `row`: of each point.
WellCenterSurface shown(const OwnSurface &surface, const Mesh &mesh, const std::vector<int> &row) {
    const auto rows = [&](auto cell) {
        for (int &v : cell)
            v = row[v];
        return cell;
    };
    const Strata &strata = surface.strata;
    WellCenterSurface out;
    for (const Facet &triangle : surface.triangles)
        out.facets.push_back(rows(triangle));
    out.patch = strata.patch;
    for (const auto &[behind, before] : surface.sides)
        out.sides.push_back({mesh.regions[behind], before < 0 ? std::nullopt : std::optional(mesh.regions[before])});
    for (const Edge &segment : strata.segments)
        out.creases.push_back(rows(segment));
    out.curve = strata.curve;
    for (std::size_t v = 0; v < strata.stratum.size(); ++v)
        if (strata.stratum[v] == Stratum::corner)
            out.corners.push_back(row[v]);
    return out;
}

/// The surface of a new mesh, with the numbers of the old one.
WellCenterSurface surface_after(const search::StratifiedMesh &made, const Mesh &mesh, const OwnSurface &own) {
    std::unordered_map<Facet, int, search::KeyHash> patch;
    for (std::size_t k = 0; k < made.facets.size(); ++k)
        patch[sorted(made.facets[k][0], made.facets[k][1], made.facets[k][2])] = made.facet_patch[k];
    OwnSurface after;
    after.sides = own.sides;
    after.triangles = surface_of(made.tets, made.region).triangles;
    for (const auto &[a, b, c] : after.triangles)
        after.strata.patch.push_back(patch.at(sorted(a, b, c)));
    after.strata.segments = made.creases;
    after.strata.curve = made.crease_curve;
    after.strata.stratum = made.stratum;
    std::vector<int> row(made.points.size());
    for (std::size_t v = 0; v < row.size(); ++v)
        row[v] = static_cast<int>(v);
    return shown(after, mesh, row);
}

/// Whether each region is the same space as before, as far as its Euler characteristic tells.
bool same_topology(const Mesh &mesh, const search::StratifiedMesh &made) {
    return geometry::euler_characteristics(mesh.cells.tets, mesh.cells.region) ==
           geometry::euler_characteristics(made.tets, made.region);
}

/// One job: the mesh that came in, what was asked, and what has been found.
class Job {
  public:
    Job(const WellCenterInput &input, const WellCenterOptions &options)
        : input_(input), options_(options), mesh_(checked(input)), own_(own_surface(mesh_, options.crease_angle)),
          bad_(count_bad(mesh_.cells.points, mesh_.cells.tets, options.goal)), listener_(options.progress, bad_) {}

    WellCenterResult run() {
        metrics_.bad_before = bad_;
        metrics_.tolerance = options_.tolerance.value_or(
            std::min(std::max(kTolerance, facet_sag(own_) / own_.diagonal), kLargestTolerance));
        if (bad_ == 0 && !options_.edge_length && few_enough(mesh_.cells.tets.size()))
            return kept();
        const std::vector<Found> tried = search();
        metrics_.stopped = listener_.stopped();
        metrics_.starts = static_cast<int>(tried.size());
        for (const Found &one : tried) {
            metrics_.passes += one.passes;
            metrics_.kicks += one.kicks;
            metrics_.evaluations += one.evaluations;
        }
        for (const std::size_t k : ranked(tried))
            if (sound(tried[k]))
                return is_better(tried[k]) ? made(tried[k]) : kept();
        return kept();
    }

  private:
    bool few_enough(std::size_t tets) const { return !options_.max_tets || tets <= *options_.max_tets; }

    std::vector<Found> search() {
        LocalSearch search(mesh_, own_,
                           find_tolerance(own_, metrics_.tolerance * own_.diagonal, workers_of(options_.threads)),
                           options_, listener_);
        std::vector<Found> tried;
        if (std::optional<search::StratifiedMesh> fresh = search.resampled({}, 0))
            tried = search.run_finer(std::move(*fresh));
        else if (!listener_.stopped() && few_enough(mesh_.cells.tets.size()))
            tried.push_back(search.run(search.own_start(), {}, std::numeric_limits<double>::infinity()));
        metrics_.exhausted = search.exhausted();
        return tried;
    }

    /// Whether a mesh is one of the domain, whatever its tets are like. Cut short, its surface may not be near yet.
    bool sound(const Found &one) const {
        return same_topology(mesh_, one.mesh) && !(listener_.stopped() && one.off > 0);
    }

    /// Whether a smaller share of the tets is bad; where something else was asked for, as small a one does.
    bool is_better(const Found &one) const {
        const std::size_t before = mesh_.cells.tets.size(), after = one.mesh.tets.size();
        if (!few_enough(before))
            return true;
        const double was = static_cast<double>(bad_) * static_cast<double>(after);
        const double is =
            static_cast<double>(count_bad(one.mesh.points, one.mesh.tets, options_.goal)) * static_cast<double>(before);
        return is < was || (is == was && options_.edge_length && !listener_.stopped());
    }

    void measure_volumes(const std::vector<double> &after) {
        const std::vector<double> before =
            volumes_of(mesh_.cells.points, mesh_.cells.tets, mesh_.cells.region, mesh_.regions.size());
        for (std::size_t r = 0; r < before.size(); ++r)
            metrics_.volumes.push_back({mesh_.regions[r], std::ldexp(before[r], 3 * mesh_.unit),
                                        std::ldexp(after.empty() ? before[r] : after[r], 3 * mesh_.unit)});
    }

    /// The mesh that came in.
    WellCenterResult kept() {
        metrics_.kept = true;
        metrics_.bad_after = bad_;
        metrics_.reached = bad_ == 0;
        measure_volumes({});
        WellCenterResult result;
        result.points.assign(input_.points.begin(), input_.points.end());
        result.tets.assign(input_.tets.begin(), input_.tets.end());
        result.regions.assign(input_.regions.begin(), input_.regions.end());
        result.regions.resize(result.tets.size(), 0);
        result.surface = shown(own_, mesh_, mesh_.origin);
        result.metrics = std::move(metrics_);
        return result;
    }

    WellCenterResult made(const Found &one) {
        const search::StratifiedMesh &mesh = one.mesh;
        metrics_.bad_after = count_bad(mesh.points, mesh.tets, options_.goal);
        metrics_.facets_off = one.off;
        metrics_.reached = metrics_.bad_after == 0 && one.off == 0;
        metrics_.released = one.released;
        measure_volumes(volumes_of(mesh.points, mesh.tets, mesh.region, mesh_.regions.size()));
        WellCenterResult result;
        for (const Vec3 &p : mesh.points)
            result.points.push_back(
                {std::ldexp(p.x, mesh_.unit), std::ldexp(p.y, mesh_.unit), std::ldexp(p.z, mesh_.unit)});
        result.tets = mesh.tets;
        for (const int region : mesh.region)
            result.regions.push_back(mesh_.regions[region]);
        result.surface = surface_after(mesh, mesh_, own_);
        result.metrics = std::move(metrics_);
        return result;
    }

    const WellCenterInput &input_;
    const WellCenterOptions &options_;
    Mesh mesh_;
    OwnSurface own_;
    std::size_t bad_;
    Listener listener_;
    WellCenterMetrics metrics_;
};

} // namespace

} // namespace library

WellCenterResult well_center(const WellCenterInput &input, const WellCenterOptions &options) {
    library::expect_options(options);
    return library::Job(input, options).run();
}

WellCenterSurface find_surface(const WellCenterInput &input, double crease_angle) {
    library::expect_angle(crease_angle);
    const library::Mesh mesh = library::checked(input);
    return library::shown(library::own_surface(mesh, crease_angle), mesh, mesh.origin);
}

} // namespace wct
