#include "sampling/resample.h"

#include "base/work.h"
#include "geometry/euler_characteristic.h"
#include "sampling/lost_domain.h"
#include "sampling/odt_relaxation.h"
#include "sampling/representation.h"
#include "sampling/sharp_edge_rows.h"
#include "sampling/size_learning.h"
#include "sampling/tet_estimate.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <tuple>
#include <utility>

namespace wct::sampling {

namespace {

/// Where the work on a start stands, of 1, when its parts begin; map and sizes come first. About: it is for those who
/// wait.
struct Milestones {
    double trials, relaxation, rounds;
};
constexpr Milestones kPlain{0.4, 0.45, 0.77}, kTried{0.2, 0.5, 0.78};

double between(double from, double to, int done, int all) {
    return from + (to - from) * static_cast<double>(done) / all;
}

/// Points whose surface edges cut across a bend, but for those of sharp edges, which are far from the next.
std::vector<char> curved_points(const Cloud &cloud, const domain::Reference &reference,
                                const domain::SharpEdges &sharp) {
    std::vector<char> curved(cloud.count(), 0);
    for (std::size_t i = 0; i < cloud.count(); ++i)
        curved[i] = on_curved(cloud, reference, static_cast<int>(i)) &&
                    !(cloud.role[i] == Stratum::crease && sharp.of_curve(cloud.label[i]));
    return curved;
}

/// Whether there are no creases, and no patch between two regions or in one.
bool is_smooth(const domain::Reference &reference) {
    return reference.curves().empty() && !reference.has_inner();
}

bool has_curved_patches(const domain::Reference &reference) {
    for (int p = 0; p < reference.patches(); ++p)
        if (!reference.planar(p))
            return true;
    return false;
}

/// Whether triangulations are mended rather than made anew. That pays where most points are inside, where a sweep moves
/// few tets; round a surface in the open every second one is another.
bool are_mostly_inside(const Cloud &cloud) {
    constexpr double most = 0.7;
    const auto inside = std::count(cloud.role.begin(), cloud.role.end(), Stratum::interior);
    return static_cast<double>(inside) > most * static_cast<double>(cloud.count());
}

void refresh_sizes(Cloud &cloud, const domain::Sizing &sizing, const Workers &workers) {
    workers.for_chunks(cloud.count(), 256, [&](std::size_t first, std::size_t last) {
        int hint = -1;
        for (std::size_t i = first; i < last; ++i)
            cloud.size[i] = sizing.at(cloud.points[i], hint);
    });
}

/// Points of tets that fitting the surface has turned over go back to where they were.
void keep_upright(Cloud &cloud, const RestrictedDelaunay &complex, const std::vector<Vec3> &before) {
    constexpr double flat = 1e-4; // six times the volume per cube of the size
    for (bool again = true; again;) {
        again = false;
        for (std::size_t t = 0; t < complex.all.tets.size(); ++t) {
            const auto &tet = complex.all.tets[t];
            const auto volume = [&](const std::vector<Vec3> &at) {
                return six_volumes(at[tet[0]], at[tet[1]], at[tet[2]], at[tet[3]]);
            };
            const double size = cloud.size[tet[0]];
            if (complex.region[t] < 0 || volume(cloud.points) > std::min(flat * size * size * size, volume(before)))
                continue;
            for (const int v : tet) {
                again = again || !(cloud.points[v] == before[v]);
                cloud.points[v] = before[v];
            }
        }
    }
}

/// Notes in statistics how long parts took.
class Stopwatch {
  public:
    explicit Stopwatch(std::vector<std::pair<std::string, double>> &stats) : stats_(stats) {}

    /// Note the seconds since the last lap.
    void lap(const std::string &name) {
        const auto now = Clock::now();
        stats_.emplace_back("seconds_" + name, std::chrono::duration<double>(now - last_).count());
        last_ = now;
    }

  private:
    using Clock = std::chrono::steady_clock;
    std::vector<std::pair<std::string, double>> &stats_;
    Clock::time_point last_ = Clock::now();
};

/// A mesh the local search may start from.
struct Start {
    Cloud cloud;
    RestrictedDelaunay complex;
    Flaws flaws;
    std::vector<int> touched; // points where sheets touched on the way
    Tally tally;
    std::size_t off = 0; // facets
    bool intact = false;
    /// Corners of strange contacts: a part is cut through there, nothing else is lost.
    std::vector<int> strange;

    std::size_t wrong() const { return tally.bad + off; }
    /// Less is better.
    std::tuple<bool, std::size_t, std::size_t> rank() const { return {!intact, strange.size(), wrong()}; }
};

/// A domain and what is asked of its resampling.
struct Task {
    domain::Reference &reference;
    const domain::InputMesh &mesh;
    const domain::RegionMap &map;
    const ResampleOptions &options;
    const std::optional<PartialRenewal> &renewal;
    const HeldSurface *held;
    Monitor &monitor;
    const Workers &workers;
};

/// Makes starts, and learns from them where sizes and offsets must change.
class Resampling : Task {
  public:
    Resampling(const Task &task, domain::Sizing &sizing, Stopwatch &watch)
        : Task(task), sizing_(sizing), watch_(watch), random_(options.seed), curved_(has_curved_patches(reference)),
          smooth_(is_smooth(reference)), tolerance_(options.sizing.tolerance),
          fit_{options.fit_target * tolerance_, options.fit_weight, options.fit_pull, options.shell * tolerance_},
          correction_(reference.data().points.size(), 0.0), ceiling_(sizing.surface),
          euler_(geometry::euler_characteristics(mesh.tets, mesh.region)), stands_(trials() > 0 ? kTried : kPlain) {}

    /// Learn from meshes that are relaxed for a few sweeps only.
    void try_out();
    /// A start; with finer sizes where it did not meet the domain, or too many facets were off. Nothing where it was
    /// stopped before there was any.
    std::optional<Start> find_start();
    /// Where the start does not meet the domain, but for corners.
    std::vector<int> lost(const Start &start) const;
    /// So far.
    long work() const { return work_; }

  private:
    /// How many: sizes do where nearly all came right.
    int trials() const { return curved_ && !renewal ? options.trials : 0; }
    Cloud seeds();
    /// Spread the points evenly for their sizes, and fill holes: on smooth bodies with momentum at first, but for a
    /// trial. Where there are creases or parts, starts have a fourth fewer bad tets with it too, but end no sooner:
    /// what is left is at the creases, more of which are given up then.
    Cloud relaxed(Cloud cloud, bool trial);
    /// Fill holes and thin crowds of the surface.
    void mend_surface(Cloud &cloud, RestrictedDelaunay &complex);
    /// Whether the last rounds brought too little for another. `fewest`: bad tets and facets off after each.
    bool settled(const std::vector<double> &fewest, const Start &best) const;
    /// Seeds, relaxed and improved, or nothing where it is stopped before.
    std::optional<Start> make_start();
    /// Triangulate, and move the points downhill, for as long as that pays; the best start on the way.
    std::optional<Start> improve(Cloud cloud);
    /// The triangulation to be mended; none where it is to be made anew, as where facets are held, which may be in
    /// none.
    delaunay::MovingDelaunay *kept(const Cloud &cloud) {
        return !held && are_mostly_inside(cloud) ? &moving_ : nullptr;
    }
    /// Whether all of the domain is in the complex.
    bool represents(const Cloud &cloud, const RestrictedDelaunay &complex, const Flaws &flaws) const;
    bool too_many_off(const Start &start) const;
    void move_downhill(Cloud &cloud, const RestrictedDelaunay &complex, const std::vector<Tie> &ties);

    domain::Sizing &sizing_;
    Stopwatch &watch_;
    Random random_;
    bool curved_; // whether any patch is
    bool smooth_; // no crease, no patch inside
    double tolerance_;
    FitForm fit_;
    std::vector<double> correction_; // of offsets, per vertex of the surface
    std::vector<double> ceiling_;    // sizes at first
    std::vector<int> euler_;         // characteristics of the regions
    std::vector<Vec3> direction_;    // see retract_to_shell
    delaunay::MovingDelaunay moving_;
    Milestones stands_;
    int tried_ = 0; // sweeps of trials so far
    long work_ = 0;
};

Cloud Resampling::seeds() {
    set_offsets(reference, sizing_, options, correction_);
    return make_seeds(reference, map, sizing_, SeedForm{}, renewal, held, random_, monitor, workers);
}

void Resampling::mend_surface(Cloud &cloud, RestrictedDelaunay &complex) {
    if (mend(cloud, reference, complex, options.longest, options.shortest) == 0)
        return;
    drop_twins(cloud);
    clear_sharp(cloud, sizing_);
    complex = restricted_delaunay(cloud, reference, map, workers, held, kept(cloud));
}

Cloud Resampling::relaxed(Cloud cloud, bool trial) {
    int left = trial ? options.trial_sweeps : options.sweeps;
    const bool steady = trial || !smooth_;
    bool settling = steady;
    for (int sweep = 0; left > 0 && !monitor.stopped(); ++sweep) {
        --left;
        drop_twins(cloud);
        work_ += WorkUnits::sweep * static_cast<long>(cloud.count());
        RestrictedDelaunay complex = restricted_delaunay(cloud, reference, map, workers, held, kept(cloud));
        if (sweep >= options.mend_from && sweep % options.mend_every == 0 && (trial || left >= options.mend_every))
            mend_surface(cloud, complex);
        const double moved = relax(cloud, reference, complex, options.step, settling ? 0.0 : options.momentum, workers);
        keep_off_sharp(cloud, reference, sizing_, workers);
        if (held)
            held->clear(cloud);
        if (sweep % options.refresh_every == options.refresh_every - 1)
            refresh_sizes(cloud, sizing_, workers);
        monitor.report(
            trial ? between(stands_.trials, stands_.relaxation, ++tried_, options.trials * options.trial_sweeps)
                  : between(stands_.relaxation, stands_.rounds, sweep + 1, options.sweeps));
        if (settling && !steady && moved < options.still)
            break;
        if (!settling && (moved < options.calm || left <= options.settling)) {
            settling = true;
            left = std::min(left, options.settling);
        }
    }
    return cloud;
}

void Resampling::try_out() {
    monitor.report(stands_.trials);
    for (int trial = 0; trial < trials() && !monitor.stopped(); ++trial) {
        Cloud cloud = relaxed(seeds(), true);
        if (monitor.stopped())
            break;
        drop_twins(cloud);
        const RestrictedDelaunay complex = restricted_delaunay(cloud, reference, map, workers, held);
        learn(measure_deviation(cloud, complex, reference, workers), sizing_, correction_, ceiling_, options);
    }
}

bool Resampling::represents(const Cloud &cloud, const RestrictedDelaunay &complex, const Flaws &flaws) const {
    return lost_points(cloud, flaws).empty() && lost_planes(cloud, complex, reference, options.sizing).empty() &&
           euler_characteristics(complex, flaws) == euler_ && (!held || held->complete(cloud, complex));
}

bool Resampling::too_many_off(const Start &start) const {
    return static_cast<double>(start.off) > options.few_off * static_cast<double>(surface_facets(start.complex).size());
}

std::vector<int> Resampling::lost(const Start &start) const {
    std::vector<int> lost = lost_points(start.cloud, start.flaws);
    const std::vector<int> planes = lost_planes(start.cloud, start.complex, reference, options.sizing);
    lost.insert(lost.end(), planes.begin(), planes.end());
    return lost;
}

void Resampling::move_downhill(Cloud &cloud, const RestrictedDelaunay &complex, const std::vector<Tie> &ties) {
    energy::EnergyForm energy = options.energy;
    if (!options.cosines)
        energy.weight2 = 0.0;
    const std::vector<Hold> held_before = cloud.held;
    if (kept(cloud)) {
        const std::vector<char> moves = points_to_move(cloud, complex, energy, options.rings);
        for (std::size_t i = 0; i < cloud.count(); ++i)
            if (!moves[i])
                cloud.held[i] = Hold::all;
    }
    descend(cloud, complex, direction_, energy, EdgeForm{}, curved_points(cloud, reference, sizing_.sharp()), fit_,
            ties, {options.iterations, options.reach}, workers);
    cloud.held = held_before;
}

bool Resampling::settled(const std::vector<double> &fewest, const Start &best) const {
    const std::size_t lately = best.intact ? options.lately : 2 * options.lately;
    if (fewest.size() <= lately)
        return false;
    const double before = fewest.end()[-1 - static_cast<std::ptrdiff_t>(lately)], now = fewest.back();
    const double least = best.intact && smooth_ ? options.least_worth * static_cast<double>(best.tally.tets) : 0.0;
    return now > options.worth * before || before - now < least;
}

std::optional<Start> Resampling::improve(Cloud cloud) {
    std::optional<Start> best;
    RestrictedDelaunay complex;
    std::vector<double> fewest; // bad tets and facets off, after each round since the domain was met
    for (int round = 0; round <= options.rounds && !monitor.stopped(); ++round) {
        std::vector<int> touched;
        work_ += WorkUnits::round * static_cast<long>(cloud.count());
        Flaws flaws =
            represent(cloud, reference, map, held, fit_.shell, direction_, complex, touched, workers, kept(cloud));
        const std::vector<Tie> ties = curved_ ? tie_surface(cloud, complex, reference, workers) : std::vector<Tie>{};
        const std::vector<Vec3> unfitted = cloud.points;
        fit_heights(cloud, reference, ties, direction_, fit_, workers);
        keep_upright(cloud, complex, unfitted);
        const Tally tally = count_bad(cloud, complex, options.cosines);
        const bool sound = represents(cloud, complex, flaws);
        const std::size_t off = count_off(cloud, ties, options.held * tolerance_);
        std::vector<int> strange = strange_contacts(complex, reference);
        if (!best || std::tuple(!sound, strange.size(), tally.bad + off) < best->rank()) {
            if (best && !best->intact)
                fewest.clear();
            best = Start{cloud, complex, std::move(flaws), std::move(touched), tally, off, sound, std::move(strange)};
        }
        fewest.push_back(static_cast<double>(best->wrong()));
        if (round == options.rounds || tally.bad == 0 || settled(fewest, *best))
            break;
        monitor.set_bad(static_cast<std::int64_t>(best->tally.bad));
        move_downhill(cloud, complex, ties);
        monitor.report(between(stands_.rounds, 1.0, round + 1, options.rounds));
    }
    return best;
}

std::optional<Start> Resampling::make_start() {
    if (monitor.stopped())
        return std::nullopt;
    Cloud cloud = seeds();
    Cloud far; // from all that moves
    if (renewal) {
        renewal->apply(cloud, reference, sizing_);
        far = renewal->split_far(cloud);
    }
    if (cloud.count() > 0)
        cloud = relaxed(std::move(cloud), false);
    cloud.append(far);
    watch_.lap("relax");
    std::optional<Start> best = improve(std::move(cloud));
    watch_.lap("descent");
    return best;
}

std::optional<Start> Resampling::find_start() {
    std::optional<Start> found = make_start();
    if (!found || renewal) // where it kept to the old mesh, that may be sound all the same
        return found;
    const auto whole = [](const Start &start) { return start.intact && start.strange.empty(); };
    for (int attempt = 0; attempt < options.attempts && !whole(*found) && !monitor.stopped(); ++attempt) {
        std::vector<int> finer = found->strange;
        if (!found->intact) {
            const std::vector<int> planes = lost_planes(found->cloud, found->complex, reference, options.sizing);
            finer.insert(finer.end(), found->touched.begin(), found->touched.end());
            finer.insert(finer.end(), planes.begin(), planes.end());
        }
        refine(found->cloud, finer, reference, sizing_);
        std::optional<Start> next = make_start();
        if (next && next->rank() < found->rank())
            found = std::move(next);
    }
    if (found->intact && too_many_off(*found) && !monitor.stopped()) {
        shrink(measure_deviation(found->cloud, found->complex, reference, workers), sizing_, options);
        std::optional<Start> next = make_start();
        if (next && next->intact && next->off < found->off)
            found = std::move(next);
    }
    return found;
}

} // namespace

Resampled resample(domain::Reference &reference, const domain::InputMesh &mesh, std::span<const double> wanted,
                   const ResampleOptions &options, const std::optional<PartialRenewal> &renewal,
                   const HeldSurface *held, Monitor &monitor, const Workers &workers) {
    Resampled result;
    Stopwatch watch(result.stats);
    const domain::RegionMap map(mesh, reference);
    watch.lap("map");
    domain::Sizing sizing(reference, mesh, map, options.sizing, wanted, workers);
    if (held)
        held->set_sizes(sizing);
    watch.lap("sizing");
    if (!options.sizing.one_row && !sizing.has_rows())
        return result;
    if (options.expected && !renewal && !options.expected(estimate_tets(reference, mesh, sizing, workers)))
        return result;
    watch.lap("estimate");
    Resampling resampling({reference, mesh, map, options, renewal, held, monitor, workers}, sizing, watch);
    resampling.try_out();
    watch.lap("trials");
    std::optional<Start> best = resampling.find_start();
    result.stopped = monitor.stopped();
    result.work = resampling.work();
    if (!best)
        return result;
    result.stats.emplace_back("off", static_cast<double>(best->off));
    if (!best->intact)
        result.lost = resampling.lost(*best);
    result.cloud = std::move(best->cloud);
    result.complex = std::move(best->complex);
    result.flaws = std::move(best->flaws);
    result.tally = best->tally;
    result.intact = best->intact;
    result.deviation = measure_deviation(result.cloud, result.complex, reference, workers);
    watch.lap("deviation");
    return result;
}

} // namespace wct::sampling
