#include "conform/round.h"

#include "geometry/closest_point.h"
#include "geometry/dihedral_angles.h"

#include <iterator>

/// What a round does about flat tets: where those of the surface belong, and how others are got rid of.
namespace wct::conform {

namespace {

constexpr double kOnSurface = 1e-5; // distance, in sizes, of what lies in the surface but for rounding
constexpr double kRoom = 0.5;       // between a new point inside and the surface, in radii of the tet it comes into
constexpr double kShift = 0.1;      // of a point that leaves a sliver's sphere, in sizes
constexpr double kNearly = 0.15;    // between points that are nearly opposite, in sizes,
constexpr double kOpposite = 1e-9;  // and those that are so

} // namespace

void Round::take_in_flat() {
    for (std::size_t t = 0; t < complex_.region.size(); ++t) {
        const auto &tet = complex_.all.tets[t];
        if (complex_.region[t] < 0 && std::none_of(tet.begin(), tet.end(), [&](int v) { return inside(v); }))
            complex_.region[t] = region_of_flat(tet);
    }
}

int Round::region_of_flat(const Tet &tet) const {
    const Vec3 middle = cloud_.centroid(tet);
    const double most = kOnSurface * cloud_.size[tet[0]];
    const domain::SurfaceData &data = reference_.data();
    std::vector<int> patches; // that it lies in: several where they meet
    reference_.tree().visit([&](const geometry::Box &box) { return box.square(middle) <= most * most; },
                            [&](std::size_t triangle) {
                                const auto &[a, b, c] = data.triangles[triangle];
                                const std::array corners{data.points[a], data.points[b], data.points[c]};
                                if (norm(geometry::closest_on(corners, middle) - middle) <= most)
                                    patches.push_back(data.patch[triangle]);
                                return false;
                            });
    if (patches.empty())
        return map_.region(middle, -1);
    const bool in_hull =
        std::any_of(patches.begin(), patches.end(), [&](int patch) { return data.sides[patch][1] < 0; });
    return in_hull ? -1 : data.sides[*std::min_element(patches.begin(), patches.end())][0];
}

void Round::peel() {
    std::vector<Edge> kept; // no crease may be lost
    for (const Segment &s : points_.segments())
        kept.push_back(sorted(s.a, s.b));
    std::sort(kept.begin(), kept.end());
    std::vector<char> flipped(spheres_.size(), 0);
    std::vector<int> queue;
    for (int t = 0; t < static_cast<int>(spheres_.size()); ++t)
        queue.push_back(t);
    for (std::size_t k = 0; k < queue.size(); ++k) {
        const int t = queue[k];
        const auto &tet = complex_.all.tets[t];
        if (complex_.region[t] < 0 || flipped[t] ||
            std::any_of(tet.begin(), tet.end(), [&](int v) { return inside(v); }))
            continue;
        std::array<int, 2> open{};
        int count = 0;
        bool wrong = false;
        for (int i = 0; i < 4; ++i)
            if (outer(t, i)) {
                if (count < 2)
                    open[count] = i;
                ++count;
                wrong = wrong || beyond(t, i);
            }
        if (count != 2 || complex_.beyond(t, open[0]) != complex_.beyond(t, open[1]) ||
            sampling::shared_patches(cloud_, reference_, tet).empty())
            continue;
        Edge lost{}, made{tet[open[0]], tet[open[1]]};
        for (int i = 0, n = 0; i < 4; ++i)
            if (i != open[0] && i != open[1])
                lost[n++] = tet[i];
        std::sort(lost.begin(), lost.end());
        wrong = wrong || share(t, open[0], made[1]) + share(t, open[1], made[0]) <= 0.0;
        const Vec3 middle = 0.5 * (cloud_.points[made[0]] + cloud_.points[made[1]]);
        if (!wrong || std::binary_search(kept.begin(), kept.end(), lost))
            continue;
        if (const domain::Foot foot = reference_.nearest(middle); probes_.off(middle, foot)) {
            ridges_.push_back({t, foot});
            continue;
        }
        complex_.region[t] = complex_.beyond(t, open[0]);
        flipped[t] = 1;
        for (const int next : complex_.all.neighbours[t])
            if (next >= 0)
                queue.push_back(next);
    }
}

void Round::mend_slivers(double share) {
    std::vector<char> touched(gone_.size(), 0);
    for (int t = 0; t < static_cast<int>(spheres_.size()); ++t) {
        const auto &tet = complex_.all.tets[t];
        if (complex_.region[t] < 0 || geometry::smallest_dihedral(corners(tet)) >= sharpest_)
            continue;
        ++faults_.slivers;
        const bool waits = std::any_of(tet.begin(), tet.end(), [&](int v) { return touched[v]; }) ||
                           (share < 1.0 && random_.uniform() >= share);
        if (!waits && !mend_sliver(t))
            continue;
        may_change_ = true;
        if (!waits)
            for (const int v : tet)
                touched[v] = 1;
    }
}

bool Round::mend_sliver(int t) {
    const auto &tet = complex_.all.tets[t];
    std::vector<int> free;
    std::copy_if(tet.begin(), tet.end(), std::back_inserter(free), [&](int v) { return inside(v); });
    if (!free.empty()) {
        const int v = free[random_.below(static_cast<int>(free.size()))];
        points_.shift(v, kShift * cloud_.size[v] * random_.normal3());
    } else if (!sampling::shared_patches(cloud_, reference_, tet).empty()) {
        split_facet({tet[0], tet[1], tet[2]}, kOff);
    } else if (has_room(spheres_[t])) {
        put_inside(t);
    } else {
        return !options_.one_sided && put_opposite(tet); // where no dual may have length zero, no rectangle may be
    }
    return true;
}

bool Round::put_opposite(const Tet &tet) {
    std::vector<int> fresh, own;
    for (const int v : tet) {
        const int patch = cloud_.label[v];
        const bool is_new = points_.origin()[v] < 0;
        if (cloud_.role[v] != Stratum::patch || !reference_.planar(patch) || (!is_new && stays(patch)))
            continue;
        (is_new ? fresh : own).push_back(v);
        for (const int w : tet) {
            const Vec3 &opposite = cloud_.points[w];
            const double off = norm(reference_.nearest(opposite, patch).point - cloud_.points[v]);
            if (w != v && off > kOpposite * cloud_.size[v] && off < kNearly * cloud_.size[v] &&
                points_.put_in_plane(v, opposite))
                return true;
        }
    }
    const std::vector<int> &movable = fresh.empty() ? own : fresh;
    if (movable.empty())
        return false;
    const int v = movable[random_.below(static_cast<int>(movable.size()))];
    return points_.put_in_plane(v, cloud_.points[v] + kShift * cloud_.size[v] * random_.normal3());
}

bool Round::has_room(const geometry::Sphere &ball) const {
    return reference_.nearest(ball.center).distance > kRoom * ball.radius;
}

} // namespace wct::conform
