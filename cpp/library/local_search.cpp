#include "library/local_search.h"

#include "base/sort_unique.h"
#include "domain/local_tolerance.h"
#include "geometry/triangle_edges.h"
#include "library/surface_lengths.h"
#include "sampling/start.h"
#include "search/crease_release.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>

namespace wct::library {

namespace {

/// The smallest tolerance in places, as a share of the largest.
constexpr double kLeast = 0.25;
/// Sweeps and tries at effort 1.
constexpr int kPasses = 12;
constexpr long kKicks = 4000;
/// How often a start is made anew with shorter edges where the search was stuck.
constexpr std::size_t kFiner = 5;
/// Edges round what is stuck, in those that were wanted there: a body of one region needs more points where the first
/// starts at that length do not come right. At interfaces, with points enough on both sides, a start of nearly even
/// size comes right oftener than one whose lattice changes from cell to cell.
constexpr double kShares[] = {1.0, 1.0, 0.6};
constexpr double kAtInterfaces = 0.8;
/// Where more than this share of the first start's tets is stuck, its search goes on for so many times its worth: a
/// whole start with shorter edges takes longer, has more tets, and comes right no oftener.
constexpr double kFewStuck = 0.002;
constexpr double kPatience = 6.0;
constexpr double kPatient = 0.4; // the part of the work that is left that this takes at most
/// What a mesh without bad tets is worth, in evaluations per tet, where another start takes less: most that come right
/// have come so by then.
constexpr double kWorth = 5000.0;
constexpr double kForever = std::numeric_limits<double>::infinity();

/// Per point the mean length of the edges there.
std::vector<double> edge_lengths(const domain::InputMesh &mesh) {
    std::vector<Edge> edges;
    for (const auto &tet : mesh.tets)
        for (const auto &[i, k] : kEdges)
            edges.push_back(sorted(tet[i], tet[k]));
    sort_unique(edges);
    std::vector<double> sum(mesh.points.size(), 0.0), count(mesh.points.size(), 0.0);
    for (const auto &[a, b] : edges)
        for (const int v : {a, b}) {
            sum[v] += norm(mesh.points[b] - mesh.points[a]);
            count[v] += 1.0;
        }
    for (std::size_t v = 0; v < sum.size(); ++v)
        sum[v] /= count[v];
    return sum;
}

} // namespace

Workers workers_of(unsigned threads) {
    return Workers(threads ? threads : std::thread::hardware_concurrency());
}

Tolerance find_tolerance(const OwnSurface &surface, double most, const Workers &workers) {
    Tolerance tolerance{most, {}};
    const domain::Reference reference(surface_data(surface));
    std::vector<double> local = domain::local_tolerance(reference, most, kLeast * most, workers);
    if (std::any_of(local.begin(), local.end(), [&](double one) { return one < most; }))
        tolerance.local = std::move(local);
    return tolerance;
}

LocalSearch::LocalSearch(const Mesh &mesh, const OwnSurface &surface, Tolerance tolerance,
                         const WellCenterOptions &options, Listener &listener)
    : mesh_(mesh), surface_(surface), tolerance_(std::move(tolerance)), options_(options), listener_(listener),
      workers_(workers_of(options.threads)), limit_(options.max_tets, mesh.cells.tets.size()),
      work_(mesh.cells.tets.size(), options.effort),
      sheets_(
          geometry::sheets_at(surface.triangles, geometry::TriangleEdges(surface.triangles), surface.points.size())) {
    if (options.edge_length)
        wanted_.assign(mesh.cells.points.size(), std::ldexp(*options.edge_length, -mesh.unit));
    else
        longest_ = longest_edges(surface);
}

search::StratifiedMesh LocalSearch::own_start() const {
    const Strata &strata = surface_.strata;
    search::StratifiedMesh start;
    start.points = mesh_.cells.points;
    start.stratum = strata.stratum;
    start.label = strata.label;
    start.size = wanted_.empty() ? edge_lengths(mesh_.cells) : wanted_;
    start.tets = mesh_.cells.tets;
    start.region = mesh_.cells.region;
    start.facets = surface_.triangles;
    start.facet_patch = strata.patch;
    start.creases = strata.segments;
    start.crease_curve = strata.curve;
    return start;
}

std::optional<search::StratifiedMesh> LocalSearch::resampled(const std::vector<domain::SizeLimit> &finer, int attempt) {
    if (!listener_.resampling(0.0))
        return {};
    sampling::ResampleOptions options;
    options.sizing.tolerance = tolerance_.most;
    options.sizing.local = tolerance_.local;
    options.sizing.most = longest_;
    options.sizing.limits = finer;
    options.cosines = options_.goal == WellCenterGoal::completely_well_centered;
    options.seed = options_.seed + 1 + static_cast<std::uint64_t>(attempt);
    options.expected = [&](double tets) { return limit_.begins(tets) && listener_.resampling(0.0); };
    Monitor monitor([&](double done, std::int64_t) { return listener_.resampling(done); });
    domain::Reference reference(surface_data(surface_));
    sampling::Resampled result =
        sampling::resample(reference, mesh_.cells, wanted_, options, {}, nullptr, monitor, workers_);
    work_.add(result.work);
    if (listener_.stopped() || result.complex.all.tets.empty())
        return {};
    sampling::free_buried(result.cloud, result.complex, reference);
    sampling::Start start =
        sampling::start_of(result, sampling::label_surface(result.cloud, result.complex, reference));
    if (!limit_.holds(start.mesh.tets.size()))
        return {};
    const auto as_there = [&](int v) { // allowed at corners where sheets of the surface itself touch
        const int row = start.place[v];
        return start.mesh.stratum[row] == Stratum::corner && sheets_[start.mesh.label[row]] > 1;
    };
    if (!result.intact || !std::all_of(result.flaws.pinched.begin(), result.flaws.pinched.end(), as_there))
        return {};
    return std::move(start.mesh);
}

Found LocalSearch::run(const search::StratifiedMesh &start, const std::vector<int> &released, double worth,
                       double part) {
    search::expect_conforming(start);
    const OwnSurface on = without(surface_, released);
    search::TetComplex complex = search::complex_of(start);
    search::SearchOptions options;
    options.acute = options_.goal == WellCenterGoal::completely_well_centered;
    options.margin = options_.margin;
    options.passes = kPasses;
    options.kicks = kKicks * options_.effort;
    options.seed = options_.seed;
    options.workers = workers_;
    options.worth = worth;
    options.work = static_cast<long>(part * static_cast<double>(work_.left()));
    options.most = limit_.most();
    options.crease = std::cos(options_.crease_angle / 180.0 * std::numbers::pi);
    const std::vector<double> volumes = enclosed_volumes(on, mesh_.regions.size());
    if (std::all_of(volumes.begin(), volumes.end(), [](double one) { return one > 0.0; }))
        options.volumes = volumes;
    search::CreaseRelease search(complex,
                                 {on.points, on.triangles, on.strata.patch, on.strata.segments, on.strata.curve,
                                  soft_curves(on.strata), 0.0, tolerance_.local},
                                 tolerance_.most, 0.125 * search::mean_surface_size(start));
    const search::SearchOutcome outcome = search.run(
        options, [&](const char *phase, double done, int bad) { return listener_.searching(phase, done, bad); });
    search::expect_kept(complex);
    work_.add(outcome.work);
    Found found{search::mesh_of(complex),
                static_cast<std::size_t>(outcome.bad),
                static_cast<std::size_t>(complex.over_count()),
                search::rows_of(complex, outcome.stuck),
                outcome.passes,
                outcome.kicks,
                outcome.evaluations,
                released};
    found.released.insert(found.released.end(), search.released().begin(), search.released().end());
    std::sort(found.released.begin(), found.released.end());
    return found;
}

std::vector<Found> LocalSearch::run_finer(search::StratifiedMesh start) {
    std::vector<Found> tried;
    std::vector<domain::SizeLimit> finer;
    std::vector<int> released; // without which the start was made
    work_.lead_to(start.tets.size());
    for (double worth = this->worth();;) {
        const bool patient = this->worth() < worth && worth < kForever;
        tried.push_back(run(start, released, worth, patient ? kPatient : 1.0));
        const Found &fewest = tried[ranked(tried).front()];
        work_.lead_to(fewest.mesh.tets.size());
        if (tried.back().stuck.empty() || listener_.stopped() || worth == kForever || work_.left() == 0)
            return tried;
        const double share = static_cast<double>(fewest.stuck.size()) / static_cast<double>(fewest.mesh.tets.size());
        if (tried.size() == 1 && share > kFewStuck) {
            start = fewest.mesh;
            released = fewest.released;
            worth = kPatience * this->worth();
            continue;
        }
        worth = this->worth();
        add_limits(fewest, tried.size(), finer);
        std::optional<search::StratifiedMesh> again;
        if (tried.size() <= kFiner)
            again = resampled(finer, static_cast<int>(tried.size()));
        if (listener_.stopped())
            return tried;
        released.clear();
        if (again)
            start = std::move(*again);
        else { // nothing else is left to try than more of the same
            worth = kForever;
            start = fewest.mesh;
            released = fewest.released;
        }
    }
}

double LocalSearch::worth() const {
    return kWorth * options_.effort;
}

void LocalSearch::add_limits(const Found &found, std::size_t tried, std::vector<domain::SizeLimit> &finer) const {
    const double share = mesh_.regions.size() > 1 ? kAtInterfaces : kShares[std::min(tried, std::size(kShares)) - 1];
    for (const int t : found.stuck) {
        Vec3 middle;
        double size = 0.0;
        for (const int v : found.mesh.tets[t]) {
            middle += 0.25 * found.mesh.points[v];
            size += 0.25 * found.mesh.size[v];
        }
        finer.push_back({middle, share * size});
    }
}

std::vector<std::size_t> ranked(const std::vector<Found> &tried) {
    std::vector<std::size_t> rows;
    for (std::size_t k = tried.size(); k-- > 0;)
        rows.push_back(k);
    std::stable_sort(rows.begin(), rows.end(),
                     [&](std::size_t a, std::size_t b) { return tried[a].bad < tried[b].bad; });
    return rows;
}

} // namespace wct::library
