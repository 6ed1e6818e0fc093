#include "sampling/representation.h"

#include "sampling/crease_recovery.h"
#include "sampling/patch_recovery.h"
#include "sampling/pinch_mending.h"
#include "sampling/sheets.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace wct::sampling {

namespace {

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

} // namespace

Flaws represent(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map, const HeldSurface *held,
                double shell, std::vector<Vec3> &direction, RestrictedDelaunay &complex, std::vector<int> &touched,
                const Workers &workers, delaunay::MovingDelaunay *moving) {
    constexpr int passes = 4;
    const auto look = [&] {
        settle(cloud, reference, held, shell, direction, workers);
        complex = restricted_delaunay(cloud, reference, map, workers, held, moving);
        Flaws flaws = find_flaws(cloud, complex);
        const std::vector<int> piercing = piercing_points(cloud, reference, complex, workers);
        flaws.exposed.insert(flaws.exposed.end(), piercing.begin(), piercing.end());
        return flaws;
    };
    Flaws flaws = look();
    for (int pass = 0; pass < passes; ++pass) {
        const bool promoted = promote(cloud, reference, complex, flaws);
        if (promoted) { // points may have gone, and with them the complex's numbers
            settle(cloud, reference, held, shell, direction, workers);
            complex = restricted_delaunay(cloud, reference, map, workers, held, moving);
        }
        const int on_creases = recover_creases(cloud, reference, complex, held, workers);
        const int on_patches = recover_patches(cloud, reference, complex, workers); // may take points away: comes last
        if (on_creases + on_patches == 0 && !promoted)
            break;
        flaws = look();
    }
    touched = flaws.pinched;
    return mend_pinches(cloud, reference, complex, std::move(flaws));
}

} // namespace wct::sampling
