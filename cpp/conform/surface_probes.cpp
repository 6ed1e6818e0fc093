#include "conform/surface_probes.h"

#include "geometry/box_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace wct::conform {

namespace {

constexpr int kSteps = 3; // of a triangle's edge

template <class Visit> void each_sample(const std::array<Vec3, 3> &corners, const Visit &visit) {
    for (int i = 0; i <= kSteps; ++i)
        for (int j = 0; i + j <= kSteps; ++j)
            if (i < kSteps && j < kSteps && i + j > 0) // corners stay
                visit(corners[0] + (static_cast<double>(i) / kSteps) * (corners[1] - corners[0]) +
                      (static_cast<double>(j) / kSteps) * (corners[2] - corners[0]));
}

Facet ascending(Facet facet) {
    std::sort(facet.begin(), facet.end());
    return facet;
}

} // namespace

SurfaceProbes::SurfaceProbes(const domain::Reference &own, const std::optional<domain::Reference> &given, double most)
    : own_(own), given_(given), most_(most), probes_(own.data().triangles.size()) {
    const domain::SurfaceData &data = own.data();
    triangle_.resize(data.triangles.size());
    std::iota(triangle_.begin(), triangle_.end(), 0);
    std::sort(triangle_.begin(), triangle_.end(),
              [&](int s, int t) { return ascending(data.triangles[s]) < ascending(data.triangles[t]); });
    for (const int t : triangle_) {
        const auto &[a, b, c] = data.triangles[t];
        facets_.push_back(ascending(data.triangles[t]));
        each_sample({data.points[a], data.points[b], data.points[c]}, [&](const Vec3 &p) {
            Probe probe{{p, t, {}, 0.0}, p};
            if (given_)
                if (const domain::Foot foot = given_->nearest(p); foot.distance <= most_)
                    probe.at = foot.point;
            probes_[t].push_back(probe);
        });
    }
}

bool SurfaceProbes::off(const Vec3 &p, const domain::Foot &foot) const {
    return foot.distance > most_ && !(given_ && given_->nearest(p).distance <= most_);
}

domain::Foot SurfaceProbes::farthest(const std::array<Vec3, 3> &corners, bool all) const {
    domain::Foot worst;
    worst.distance = -1.0;
    each_sample(corners, [&](const Vec3 &p) {
        const domain::Foot foot = own_.nearest(p);
        if (foot.distance > worst.distance && (all || off(p, foot)))
            worst = foot;
    });
    return worst;
}

bool SurfaceProbes::is_own(Facet facet, std::span<const int> origin) const {
    for (int &v : facet)
        v = origin[v];
    return facet[0] >= 0 && facet[1] >= 0 && facet[2] >= 0 &&
           std::binary_search(facets_.begin(), facets_.end(), ascending(facet));
}

std::vector<domain::Foot> SurfaceProbes::missed(std::span<const Vec3> points, std::span<const Facet> facets,
                                                std::span<const int> origin) const {
    std::vector<char> there(facets_.size(), 0);
    std::vector<geometry::Box> boxes;
    for (const Facet &facet : facets) {
        geometry::Box box;
        for (const int v : facet)
            box.add(points[v]);
        boxes.push_back(box);
        if (is_own(facet, origin)) {
            const Facet name = ascending({origin[facet[0]], origin[facet[1]], origin[facet[2]]});
            there[std::lower_bound(facets_.begin(), facets_.end(), name) - facets_.begin()] = 1;
        }
    }
    const geometry::BoxTree tree(boxes);
    std::vector<domain::Foot> out;
    for (std::size_t k = 0; k < facets_.size(); ++k) {
        domain::Foot worst;
        double far = most_;
        for (const Probe &probe : probes_[triangle_[k]]) {
            if (there[k])
                break;
            const double square = tree.minimise(
                std::numeric_limits<double>::infinity(),
                [&](std::size_t node) { return tree.box(node).square(probe.at); },
                [&](std::size_t item, double) {
                    const auto &[a, b, c] = facets[item];
                    return geometry::nearest_on_triangle(probe.at, points[a], points[b], points[c]).square;
                });
            if (std::sqrt(square) > far) {
                far = std::sqrt(square);
                worst = probe.foot;
            }
        }
        if (worst.triangle >= 0)
            out.push_back(worst);
    }
    return out;
}

} // namespace wct::conform
