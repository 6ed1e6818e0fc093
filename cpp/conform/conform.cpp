#include "conform/conform.h"

#include "conform/round.h"
#include "conform/surface_probes.h"
#include "geometry/dihedral_angles.h"
#include "geometry/euler_characteristic.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

namespace wct::conform {

namespace {

Conformed taken(const ConformingCloud &points, const sampling::RestrictedDelaunay &complex,
                const domain::Reference &reference) {
    const sampling::Cloud &cloud = points.points();
    Conformed out;
    out.surface = sampling::label_surface(cloud, complex, reference);
    out.surface.creases.clear();
    out.surface.curve.clear();
    for (const auto &[a, b, curve] : points.segments()) {
        out.surface.creases.push_back(sorted(a, b));
        out.surface.curve.push_back(curve);
    }
    out.points = cloud.points;
    out.origin = points.origin();
    out.role = cloud.role;
    out.size = cloud.size;
    out.label = cloud.label;
    complex.append_inside(out.tets, out.region);
    return out;
}

} // namespace

Conformed conform(const domain::Reference &reference, const std::optional<domain::Reference> &given,
                  const domain::InputMesh &mesh, std::span<const Stratum> stratum, std::span<const int> label,
                  std::span<const double> size, const ConformOptions &options, Monitor &monitor,
                  const Workers &workers) {
    const domain::RegionMap map(mesh, reference);
    const std::vector<int> euler = geometry::euler_characteristics(mesh.tets, mesh.region);
    const SurfaceProbes probes(reference, given, options.held * options.tolerance);
    ConformingCloud points(reference, mesh, stratum, label, size), of_best = points;
    double sharpest = std::numeric_limits<double>::infinity();
    for (const auto &[a, b, c, d] : mesh.tets)
        sharpest = std::min(
            sharpest, geometry::smallest_dihedral({mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[d]}));
    sharpest *= options.sharpest;
    Random random(options.seed);
    Conformed best;
    int since = 0, astray = 0;
    // Where nothing but slivers is left, changes against too many at once may bring faults back: then fewer are made.
    double share = 1.0;
    for (int round = 0;
         round < options.effort * options.rounds && since < options.effort * options.patience && !monitor.stopped();
         ++round) {
        Round now(points, reference, probes, map, options, sharpest, random, workers);
        ConformingCloud before = points;
        const Faults faults = now.mend(share);
        const bool intact = faults.unsound() == 0 &&
                            geometry::euler_characteristics(now.complex().all.tets, now.complex().region) == euler;
        if (round == 0 || std::tuple(!intact, faults.all(), faults.slivers) <
                              std::tuple(!best.intact, best.faults.all(), best.faults.slivers)) {
            best = taken(before, now.complex(), reference);
            best.faults = faults;
            best.intact = intact;
            of_best = std::move(before);
            since = 0;
            share = std::min(1.0, 2.0 * share);
        } else {
            ++since;
        }
        astray = faults.all() == 0 ? 0 : astray + 1;
        if (astray == options.astray && !options.one_sided && best.intact && best.faults.all() == 0) {
            points = of_best;
            share = std::max(options.fewest, 0.5 * share);
            astray = 0;
        }
        best.rounds = round + 1;
        monitor.set_bad(static_cast<std::int64_t>(best.faults.outer + best.faults.edges + best.faults.ties));
        // A round takes far longer than its tets' evaluations: who may stop it is asked after each.
        monitor.report(static_cast<double>(round) / (options.effort * options.rounds));
        const bool overgrown =
            since > 0 && now.complex().all.tets.size() > options.effort * options.most(mesh.tets.size());
        if (overgrown || (intact && faults.all() == 0 && !now.may_change()))
            break;
    }
    best.stopped = monitor.stopped();
    return best;
}

} // namespace wct::conform
