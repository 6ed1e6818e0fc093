#include "sampling/resample.h"

#include "geometry/euler_characteristic.h"
#include "sampling/crease_recovery.h"
#include "sampling/lost_domain.h"
#include "sampling/odt_relaxation.h"
#include "sampling/pinch_mending.h"
#include "sampling/plane_recovery.h"
#include "sampling/sharp_edge_rows.h"
#include "sampling/sheets.h"
#include "sampling/tet_estimate.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace wct::sampling {

namespace {

/// Where vertices sit over curved patches and creases: outside of the bend, so that chords run on both sides of it.
void set_offsets(domain::Reference &reference, const domain::Sizing &sizing, const ResampleOptions &options,
                 const std::vector<double> &correction) {
    for (int w = 0; w < reference.wedges(); ++w) {
        const auto &k = reference.curvature(w);
        const double size = sizing.surface[reference.wedge_vertex(w)];
        const double most = options.shell * options.sizing.tolerance_at(reference.wedge_vertex(w));
        // (k1 + k2) size^2 / 16 is the mean sag of an equilateral facet, and keeps the volume; half of what an
        // irregular one may sag centers it in the tolerance.
        const double mean = k[0] + k[1];
        const double deep = domain::unit_sag(k[0], k[1]) * 8.0;
        const double middle = 1.4 * (k[0] * k[1] > 0.0 ? (k[0] > 0.0 ? deep : -deep) : mean);
        const double half = 0.5 * (mean + middle);
        const double offset = options.offset * half * size * size / 16.0 + correction[reference.wedge_vertex(w)];
        reference.offset[w] = std::clamp(offset, -most, most);
    }
    for (std::size_t c = 0; c < reference.curves().size(); ++c) {
        domain::Curve &curve = reference.curves()[c];
        if (reference.bare(static_cast<int>(c))) // keeps its own corners
            continue;
        for (std::size_t k = 0; k < curve.vertices.size(); ++k) {
            const double size = sizing.surface[curve.vertices[k]];
            const double most = options.shell * options.sizing.tolerance_at(curve.vertices[k]);
            const Vec3 shift = (-1.33 * options.offset * size * size / 16.0) * curve.bend[k];
            const double far = norm(shift);
            curve.shift[k] = far > most ? (most / far) * shift : shift;
        }
        if (!curve.closed && !curve.vertices.empty())
            curve.shift.front() = curve.shift.back() = {}; // corners stay
    }
    reference.rebuild_curves();
}

/// Shift offsets and shrink sizes where the measured deviation asks for it. They grow again, up to where they were at
/// the start, where they were shrunk too much.
void learn(const Deviation &deviation, domain::Sizing &sizing, std::vector<double> &correction,
           const std::vector<double> &ceiling, const ResampleOptions &options) {
    for (std::size_t v = 0; v < correction.size(); ++v) {
        const double tolerance = options.sizing.tolerance_at(static_cast<int>(v));
        const double up = deviation.above[v];
        const double down = deviation.below[v];
        // Offsets keep the volume as they are; only what leaves the tolerance is a reason to shift them.
        const double excess = std::max(0.0, std::max(up, -down) - options.target * tolerance);
        correction[v] += std::clamp(-0.5 * (up + down), -excess, excess);
        const double half = std::max(0.5 * (up - down), 0.75 * std::max({up, -down, deviation.missed[v]}));
        const double change = half > 0.0 ? std::sqrt(options.target * tolerance / half) : 2.0;
        sizing.surface[v] = std::min(sizing.surface[v] * std::clamp(change, 0.7, 1.08), ceiling[v]);
    }
    sizing.grade();
}

/// Shrink sizes where facets are off the tolerance, or nearly: the local search mends few of them, and slowly.
void shrink(const Deviation &deviation, domain::Sizing &sizing, const ResampleOptions &options) {
    for (std::size_t v = 0; v < sizing.surface.size(); ++v) {
        const double tolerance = options.sizing.tolerance_at(static_cast<int>(v));
        const double far = std::max({deviation.above[v], -deviation.below[v], deviation.missed[v]});
        if (far > options.held * tolerance)
            sizing.surface[v] *= std::max(std::sqrt(options.target * tolerance / far), 0.7);
    }
    sizing.grade();
}

/// Drop crease points that crowd another of their curve, or its end, and patch points that crowd a crease: the descent
/// may push them together where a curve cannot be recovered. True if any did.
bool thin_creases(Cloud &cloud, const domain::Reference &reference) {
    constexpr double share = 0.2;  // of the size
    std::map<int, double> corners; // vertex of the reference -> size
    for (std::size_t i = 0; i < cloud.count(); ++i)
        if (cloud.role[i] == Stratum::corner)
            corners[cloud.label[i]] = cloud.size[i];
    std::map<int, PointGrid> grids;
    for (int c = 0; c < static_cast<int>(reference.curves().size()); ++c) {
        const domain::Curve &curve = reference.curves()[c];
        if (!curve.closed && !curve.vertices.empty())
            for (const int end : {curve.vertices.front(), curve.vertices.back()})
                if (const auto found = corners.find(end); found != corners.end())
                    grids[c].add(reference.data().points[end], share * found->second);
    }
    std::vector<char> keep(cloud.count(), 1);
    bool any = false;
    PointGrid creases;
    for (std::size_t i = 0; i < cloud.count(); ++i) {
        if (cloud.role[i] == Stratum::corner)
            creases.add(cloud.points[i], share * cloud.size[i]);
        if (cloud.role[i] != Stratum::crease)
            continue;
        PointGrid &grid = grids[cloud.label[i]];
        const double radius = share * cloud.size[i];
        if (cloud.held[i] != Hold::given && grid.crowded(cloud.points[i], radius)) {
            keep[i] = 0;
            any = true;
        } else {
            grid.add(cloud.points[i], radius);
            creases.add(cloud.points[i], radius);
        }
    }
    for (std::size_t i = 0; i < cloud.count(); ++i)
        if (cloud.role[i] == Stratum::patch && cloud.held[i] != Hold::given &&
            creases.crowded(cloud.points[i], share * cloud.size[i])) {
            keep[i] = 0;
            any = true;
        }
    if (any)
        cloud.keep(keep);
    return any;
}

/// Every boundary point on its stratum, no two at one place, none where held facets would suffer.
void settle(Cloud &cloud, const domain::Reference &reference, const HeldSurface *held, double shell,
            std::vector<Vec3> &direction, const Workers &workers) {
    if (held)
        held->clear(cloud);
    do
        retract_to_shell(cloud, reference, shell, direction, workers);
    while (drop_twins(cloud) || thin_creases(cloud, reference));
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

bool has_curved_patches(const domain::Reference &reference) {
    for (int p = 0; p < reference.patches(); ++p)
        if (!reference.planar(p))
            return true;
    return false;
}

void refresh_sizes(Cloud &cloud, const domain::Sizing &sizing, const Workers &workers) {
    workers.for_each(cloud.count(), 256, [&](std::size_t i) { cloud.size[i] = sizing.at(cloud.points[i]); });
}

/// Shrink sizes at points where facets are too large: sheets touched each other, facets cut across, or creases have
/// gaps.
void refine(const Cloud &cloud, const std::vector<int> &touched, const domain::Reference &reference,
            domain::Sizing &sizing) {
    constexpr double share = 0.6;
    for (const int i : touched) {
        const domain::Foot foot = reference.nearest(cloud.points[i]);
        for (const int v : reference.data().triangles[foot.triangle]) {
            const double far = norm(reference.data().points[v] - foot.point);
            sizing.surface[v] = std::min(sizing.surface[v], share * cloud.size[i] + sizing.form().surface_grade * far);
        }
    }
    sizing.grade();
}

/// Interior points that lie open on the surface become surface points, or go where they would crowd it: a flood of them
/// would press the surface points round them into flat tets.
bool promote(Cloud &cloud, const domain::Reference &reference, const RestrictedDelaunay &complex, const Flaws &flaws) {
    constexpr double crowded = 0.5;                                                   // of the size
    std::vector<double> room(cloud.count(), std::numeric_limits<double>::infinity()); // to the nearest surface point
    std::vector<char> open(cloud.count(), 0), keep(cloud.count(), 1);
    for (const int v : flaws.exposed)
        open[v] = 1;
    for (const auto &tet : complex.all.tets)
        for (const int v : tet)
            for (const int w : tet)
                if (open[v] && cloud.role[w] != Stratum::interior)
                    room[v] = std::min(room[v], norm(cloud.points[v] - cloud.points[w]));
    for (const int v : flaws.exposed) {
        if (room[v] < crowded * cloud.size[v]) {
            keep[v] = 0;
            continue;
        }
        const domain::Foot foot = reference.nearest(cloud.points[v]);
        cloud.role[v] = Stratum::patch;
        cloud.label[v] = reference.data().patch[foot.triangle];
        cloud.near[v] = foot.triangle;
    }
    cloud.keep(keep);
    return !flaws.exposed.empty();
}

/// Points of tets that fitting the surface has turned over go back to where they were.
void keep_upright(Cloud &cloud, const RestrictedDelaunay &complex, const std::vector<Vec3> &before) {
    constexpr double flat = 1e-4; // six times the volume per cube of the size
    for (bool again = true; again;) {
        again = false;
        for (std::size_t t = 0; t < complex.all.tets.size(); ++t) {
            const auto &tet = complex.all.tets[t];
            const auto volume = [&](const std::vector<Vec3> &at) {
                return dot(cross(at[tet[1]] - at[tet[0]], at[tet[2]] - at[tet[0]]), at[tet[3]] - at[tet[0]]);
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

/// The complex of the settled points, changed until the domain's creases and surfaces are in it. `touched` receives the
/// points where sheets touched on the way.
Flaws represent(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map, const HeldSurface *held,
                double shell, std::vector<Vec3> &direction, RestrictedDelaunay &complex, std::vector<int> &touched,
                const Workers &workers) {
    const auto look = [&] {
        settle(cloud, reference, held, shell, direction, workers);
        complex = restricted_delaunay(cloud, reference, map, workers, held);
        Flaws flaws = find_flaws(cloud, complex);
        const std::vector<int> piercing = piercing_points(cloud, reference, complex, workers);
        flaws.exposed.insert(flaws.exposed.end(), piercing.begin(), piercing.end());
        return flaws;
    };
    Flaws flaws = look();
    for (int pass = 0; pass < 4; ++pass) {
        const bool promoted = promote(cloud, reference, complex, flaws);
        if (promoted) { // points may have gone, and with them the complex's numbers
            settle(cloud, reference, held, shell, direction, workers);
            complex = restricted_delaunay(cloud, reference, map, workers, held);
        }
        const int on_creases = recover_creases(cloud, reference, complex, held, workers);
        const int on_planes = recover_planes(cloud, reference, complex, workers); // may take points away: comes last
        if (on_creases + on_planes == 0 && !promoted)
            break;
        flaws = look();
    }
    touched = flaws.pinched;
    return mend_pinches(cloud, reference, complex, std::move(flaws));
}

/// A mesh the local search may start from.
struct Start {
    Cloud cloud;
    RestrictedDelaunay complex;
    Flaws flaws;
    std::vector<int> touched; // points where sheets touched on the way
    Tally tally;
    std::size_t off = 0; // facets
    bool intact = false;
};

} // namespace

Resampled resample(domain::Reference &reference, const domain::InputMesh &mesh, std::span<const double> wanted,
                   const ResampleOptions &options, const std::optional<PartialRenewal> &renewal,
                   const HeldSurface *held, Monitor &monitor, const Workers &workers) {
    using Clock = std::chrono::steady_clock;
    auto last = Clock::now();
    Resampled result;
    const auto lap = [&](const std::string &name) {
        const auto now = Clock::now();
        result.stats.emplace_back("seconds_" + name, std::chrono::duration<double>(now - last).count());
        last = now;
    };
    const domain::RegionMap map(mesh, reference);
    lap("map");
    domain::Sizing sizing(reference, mesh, map, options.sizing, wanted, workers);
    if (held)
        held->set_sizes(sizing);
    lap("sizing");
    if (options.expected && !renewal && !options.expected(estimate_tets(reference, mesh, sizing, workers)))
        return result;
    lap("estimate");
    std::vector<double> correction(reference.data().points.size(), 0.0);
    const std::vector<double> ceiling = sizing.surface;
    Random random(options.seed);
    const bool curved = has_curved_patches(reference);
    const auto seeds = [&] {
        set_offsets(reference, sizing, options, correction);
        return make_seeds(reference, map, sizing, SeedForm{}, renewal, held, random, workers);
    };
    const auto relaxed = [&](Cloud cloud, int sweeps) {
        for (int sweep = 0; sweep < sweeps && !monitor.stopped(); ++sweep) {
            drop_twins(cloud);
            RestrictedDelaunay complex = restricted_delaunay(cloud, reference, map, workers, held);
            if (sweep >= options.mend_from && sweep % 4 == 0 && sweep + 4 < options.sweeps)
                if (mend(cloud, reference, complex, options.longest, options.shortest) > 0) {
                    drop_twins(cloud);
                    clear_sharp(cloud, sizing);
                    complex = restricted_delaunay(cloud, reference, map, workers, held);
                }
            relax(cloud, reference, complex, options.step, workers);
            keep_off_sharp(cloud, reference, sizing, workers);
            if (held)
                held->clear(cloud);
            if (sweep % 8 == 7)
                refresh_sizes(cloud, sizing, workers);
            monitor.report(0.0); // a sweep takes far longer than so many evaluations
        }
        return cloud;
    };
    const int trials = curved && !renewal ? options.trials : 0; // sizes do where nearly all came right
    for (int trial = 0; trial < trials && !monitor.stopped(); ++trial) {
        Cloud cloud = relaxed(seeds(), options.trial_sweeps);
        if (monitor.stopped())
            break;
        drop_twins(cloud);
        const RestrictedDelaunay complex = restricted_delaunay(cloud, reference, map, workers, held);
        learn(measure_deviation(cloud, complex, reference, workers), sizing, correction, ceiling, options);
    }
    lap("trials");
    const std::vector<int> euler = geometry::euler_characteristics(mesh.tets, mesh.region);
    const double tolerance = options.sizing.tolerance;
    const auto represents = [&](const Cloud &cloud, const RestrictedDelaunay &complex, const Flaws &flaws) {
        return lost_points(cloud, flaws).empty() && lost_planes(cloud, complex, reference, options.sizing).empty() &&
               geometry::euler_characteristics(complex.all.tets, complex.region) == euler &&
               (!held || held->complete(cloud, complex));
    };
    std::vector<Vec3> direction;
    const double shell = options.shell * tolerance;
    const FitForm fit{options.fit_target * tolerance, options.fit_weight, options.fit_pull, shell};
    const auto run = [&]() -> std::optional<Start> { // nothing where it is stopped before the first round
        std::optional<Start> best;
        if (monitor.stopped())
            return best;
        Cloud cloud = seeds();
        Cloud far; // from all that moves
        if (renewal) {
            renewal->apply(cloud, sizing);
            far = renewal->split_far(cloud);
        }
        if (cloud.count() > 0)
            cloud = relaxed(std::move(cloud), options.sweeps);
        cloud.append(far);
        lap("relax");
        RestrictedDelaunay complex;
        std::vector<int> touched;
        std::vector<double> fewest; // bad tets and facets off, after each round since the domain was met
        for (int round = 0; round <= options.rounds && !monitor.stopped(); ++round) {
            Flaws flaws = represent(cloud, reference, map, held, shell, direction, complex, touched, workers);
            const std::vector<Tie> ties = curved ? tie_surface(cloud, complex, reference, workers) : std::vector<Tie>{};
            const std::vector<Vec3> unfitted = cloud.points;
            fit_heights(cloud, reference, ties, direction, fit, workers);
            keep_upright(cloud, complex, unfitted);
            const Tally tally = count_bad(cloud, complex, options.cosines);
            const bool sound = represents(cloud, complex, flaws);
            const std::size_t off = count_off(cloud, ties, options.held * tolerance);
            if (!best || std::pair(!sound, tally.bad + off) < std::pair(!best->intact, best->tally.bad + best->off)) {
                if (best && !best->intact)
                    fewest.clear();
                best = Start{cloud, complex, std::move(flaws), std::move(touched), tally, off, sound};
            }
            fewest.push_back(static_cast<double>(best->tally.bad + best->off));
            const std::size_t lately = best->intact ? options.lately : 2 * options.lately;
            const bool settled = fewest.size() > lately && fewest.back() > options.worth * fewest.end()[-1 - lately];
            if (round == options.rounds || tally.bad == 0 || settled)
                break;
            monitor.set_bad(static_cast<std::int64_t>(best->tally.bad));
            energy::EnergyForm energy = options.energy;
            if (!options.cosines)
                energy.weight2 = 0.0;
            descend(cloud, complex, direction, energy, EdgeForm{}, curved_points(cloud, reference, sizing.sharp()), fit,
                    ties, options.iterations, options.reach);
            monitor.report(static_cast<double>(round) / options.rounds);
        }
        lap("descent");
        return best;
    };
    std::optional<Start> found = run();
    const int attempts =
        renewal ? 0 : options.attempts; // where it kept to the old mesh, that may be sound all the same
    for (int attempt = 0; attempt < attempts && found && !found->intact && !monitor.stopped(); ++attempt) {
        const std::vector<int> lost = lost_planes(found->cloud, found->complex, reference, options.sizing);
        found->touched.insert(found->touched.end(), lost.begin(), lost.end());
        refine(found->cloud, found->touched, reference, sizing);
        std::optional<Start> next = run();
        if (next && (next->intact || next->tally.bad + next->off < found->tally.bad + found->off))
            found = std::move(next);
    }
    const auto too_many_off = [&](const Start &start) {
        return static_cast<double>(start.off) >
               options.few_off * static_cast<double>(surface_facets(start.complex).size());
    };
    if (!renewal && found && found->intact && too_many_off(*found) && !monitor.stopped()) {
        shrink(measure_deviation(found->cloud, found->complex, reference, workers), sizing, options);
        std::optional<Start> next = run();
        if (next && next->intact && next->off < found->off)
            found = std::move(next);
    }
    result.stopped = monitor.stopped();
    if (!found)
        return result;
    Start &best = *found;
    result.stats.emplace_back("off", static_cast<double>(best.off));
    if (!best.intact) {
        result.lost = lost_points(best.cloud, best.flaws);
        const std::vector<int> planes = lost_planes(best.cloud, best.complex, reference, options.sizing);
        result.lost.insert(result.lost.end(), planes.begin(), planes.end());
    }
    result.cloud = std::move(best.cloud);
    result.complex = std::move(best.complex);
    result.flaws = std::move(best.flaws);
    result.tally = best.tally;
    result.intact = best.intact;
    result.deviation = measure_deviation(result.cloud, result.complex, reference, workers);
    lap("deviation");
    return result;
}

} // namespace wct::sampling
