#include "sampling/partial_renewal.h"

#include <algorithm>
#include <set>
#include <utility>

namespace wct::sampling {

namespace {
/// As far beside a zone points may move, in its radii. Within 2 as few tets come right as before, all free takes longer
/// for nothing.
constexpr double kBeside = 3.0;
} // namespace

PartialRenewal::PartialRenewal(Cloud mesh, std::span<const Zone> zones)
    : mesh_(std::move(mesh)), zones_(zones.begin(), zones.end()) {}

bool PartialRenewal::within(const Vec3 &p, double radii, double more) const {
    return std::any_of(zones_.begin(), zones_.end(),
                       [&](const Zone &zone) { return norm(p - zone.at) <= radii * zone.radius + more; });
}

void PartialRenewal::apply(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing) const {
    constexpr double apart = 0.75; // in sizes, of new points from old ones
    const auto hold = [&](const Vec3 &p) { return within(p, kBeside, 0.0) ? Hold::none : Hold::all; };
    // Wires and flat rims with corners of their own have edges as near to them as is allowed: between other points they
    // would cut across.
    std::set<int> cornered;
    for (std::size_t i = 0; i < cloud.count(); ++i)
        if (cloud.role[i] == Stratum::crease && cloud.held[i] == Hold::descent && reference.bare(cloud.label[i]) &&
            !reference.curves()[cloud.label[i]].straight)
            cornered.insert(cloud.label[i]);
    Cloud old = mesh_;
    for (std::size_t i = 0; i < old.count(); ++i)
        if (old.role[i] == Stratum::crease && cornered.contains(old.label[i]))
            old.held[i] = Hold::all;
    std::vector<char> stays(old.count());
    std::set<int> corners; // that stay
    PointGrid grid;
    for (std::size_t i = 0; i < old.count(); ++i) {
        stays[i] = old.held[i] == Hold::all || !reaches(old.points[i], 0.0);
        if (!stays[i])
            continue;
        if (old.role[i] == Stratum::corner)
            corners.insert(old.label[i]);
        old.size[i] = sizing.at(old.points[i]);
        grid.add(old.points[i], apart * old.size[i]);
    }
    std::vector<char> fresh(cloud.count());
    for (std::size_t i = 0; i < cloud.count(); ++i) {
        const Vec3 &p = cloud.points[i];
        if (cloud.held[i] == Hold::given) {
            fresh[i] = 1;
            continue;
        }
        fresh[i] = cloud.role[i] == Stratum::corner ? !corners.contains(cloud.label[i])
                                                    : reaches(p, 0.0) && !grid.crowded(p, apart * cloud.size[i]);
        if (hold(p) == Hold::all)
            cloud.held[i] = Hold::all;
    }
    cloud.keep(fresh);
    for (std::size_t i = 0; i < old.count(); ++i)
        if (stays[i]) {
            cloud.add(old.points[i], old.role[i], old.label[i], old.size[i]);
            cloud.held.back() = std::max(old.held[i], hold(old.points[i]));
        }
}

Cloud PartialRenewal::split_far(Cloud &cloud) const {
    constexpr double across = 4.0; // sizes from what may move to what is no neighbour, whatever the tets between
    std::vector<char> near(cloud.count());
    for (std::size_t i = 0; i < cloud.count(); ++i)
        near[i] = within(cloud.points[i], kBeside, across * cloud.size[i]);
    Cloud far = cloud;
    cloud.keep(near);
    for (char &which : near)
        which = !which;
    far.keep(near);
    return far;
}

} // namespace wct::sampling
