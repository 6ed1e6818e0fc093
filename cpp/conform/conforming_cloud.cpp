#include "conform/conforming_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wct::conform {

ConformingCloud::ConformingCloud(const domain::Reference &reference, const domain::InputMesh &mesh,
                                 std::span<const Stratum> stratum, std::span<const int> label,
                                 std::span<const double> size)
    : reference_(&reference), size_(size) {
    std::vector<int> region(mesh.points.size(), -1);
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
        for (const int v : mesh.tets[t])
            region[v] = mesh.region[t];
    std::vector<int> place(mesh.points.size(), -1);
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        if (region[v] < 0)
            continue; // in no tet
        const int own = stratum[v] == Stratum::interior ? region[v]
                        : stratum[v] == Stratum::corner ? static_cast<int>(v)
                                                        : static_cast<int>(label[v]);
        place[v] = static_cast<int>(cloud_.count());
        cloud_.add(mesh.points[v], stratum[v], own, size[v]);
        origin_.push_back(static_cast<int>(v));
    }
    const domain::SurfaceData &data = reference.data();
    for (std::size_t k = 0; k < data.segments.size(); ++k)
        segments_.push_back({place[data.segments[k][0]], place[data.segments[k][1]], data.curve[k]});
}

void ConformingCloud::begin_round() {
    surface_ = fresh_ = {};
    for (std::size_t i = 0; i < cloud_.count(); ++i)
        if (cloud_.role[i] != Stratum::interior)
            surface_.add(cloud_.points[i], kLeast * cloud_.size[i]);
}

void ConformingCloud::remove(const std::vector<char> &gone) {
    std::vector<char> keep(cloud_.count(), 1);
    std::vector<int> place(cloud_.count(), -1);
    std::size_t next = 0;
    for (std::size_t i = 0; i < cloud_.count(); ++i) {
        keep[i] = i >= gone.size() || !gone[i] || cloud_.role[i] != Stratum::interior;
        if (keep[i]) {
            origin_[next] = origin_[i];
            place[i] = static_cast<int>(next++);
        }
    }
    origin_.resize(next);
    cloud_.keep(keep);
    for (Segment &segment : segments_) {
        segment.a = place[segment.a];
        segment.b = place[segment.b];
    }
}

bool ConformingCloud::split(std::size_t segment) {
    const Segment old = segments_[segment];
    const Vec3 &a = cloud_.points[old.a], &b = cloud_.points[old.b];
    const double length = norm(b - a);
    double share = 0.5;
    const bool from_a = cloud_.role[old.a] == Stratum::corner, from_b = cloud_.role[old.b] == Stratum::corner;
    if (from_a != from_b) {
        const double shell = std::exp2(std::round(std::log2(0.5 * length))) / length; // in (0.35, 0.71)
        share = from_a ? shell : 1.0 - shell;
    }
    const double size = 0.5 * (cloud_.size[old.a] + cloud_.size[old.b]);
    const double near = std::min(share, 1.0 - share) * length;
    if (near < kLeast * size || !put(a + share * (b - a), Stratum::crease, old.curve, size, 0.5 * near))
        return false;
    const int middle = static_cast<int>(cloud_.count()) - 1;
    segments_[segment] = {old.a, middle, old.curve};
    segments_.push_back({middle, old.b, old.curve});
    return true;
}

bool ConformingCloud::insert_on_patch(const Vec3 &p, int patch, double size, double apart) {
    // A point inside a crease's ball would take the crease out of the mesh.
    std::size_t hit = segments_.size();
    double depth = 1.0;
    for (std::size_t k = 0; k < segments_.size(); ++k) {
        const Segment &s = segments_[k];
        const Vec3 middle = 0.5 * (cloud_.points[s.a] + cloud_.points[s.b]);
        const double radius = 0.5 * norm(cloud_.points[s.a] - cloud_.points[s.b]);
        const double share = norm(p - middle) / radius;
        const auto &around = reference_->patches_at_curve(s.curve);
        if (share < depth && std::binary_search(around.begin(), around.end(), patch)) {
            depth = share;
            hit = k;
        }
    }
    if (hit < segments_.size())
        return split(hit);
    return apart >= kLeast * size && put(on_patch(p, patch), Stratum::patch, patch, size, apart);
}

bool ConformingCloud::insert_inside(const Vec3 &p, int region, double size, double apart) {
    return apart >= kLeast * size && put(p, Stratum::interior, region, size, apart);
}

bool ConformingCloud::put_in_plane(int point, const Vec3 &near) {
    const Vec3 at = on_patch(near, cloud_.label[point]);
    const double apart = kLeast * cloud_.size[point];
    if (fresh_.crowded(at, apart) || surface_.crowded(at, apart, &cloud_.points[point]))
        return false;
    fresh_.add(at, apart);
    cloud_.points[point] = at;
    return true;
}

Vec3 ConformingCloud::on_patch(const Vec3 &near, int patch) const {
    const domain::Foot foot = reference_->nearest(near, patch);
    Vec3 on = foot.point;
    if (reference_->planar(patch)) // the point nearest to a triangle is off its plane by a rounding
        reference_->to_patch(on, foot);
    return on;
}

bool ConformingCloud::put(const Vec3 &p, Stratum role, int label, double size, double apart) {
    if (fresh_.crowded(p, apart) || surface_.crowded(p, kLeast * size))
        return false;
    fresh_.add(p, apart);
    cloud_.add(p, role, label, size);
    origin_.push_back(-1);
    return true;
}

} // namespace wct::conform
