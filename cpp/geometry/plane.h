#pragma once

#include "base/cells.h"
#include "base/vec3.h"

#include <algorithm>
#include <span>

namespace wct::geometry {

/// Whether a patch (curve) of this extent is a plane (line) when no vertex is farther off one than `off`: at most 1e-9
/// of the extent, or `flat`, what files and noise are known to have moved them by.
inline bool is_flat(double off, double extent, double flat) {
    constexpr double kFlat = 1e-9;
    return off <= std::max(kFlat * extent, flat);
}

/// A plane through a point. What is put on one across an axis gets exactly the origin's coordinate.
class Plane {
  public:
    Plane() = default;
    /// `across`: normal, of any length.
    Plane(const Vec3 &across, const Vec3 &origin) : normal_(unit(across)), origin_(origin) {
        const bool x = across.x != 0.0, y = across.y != 0.0, z = across.z != 0.0;
        if (x + y + z == 1)
            axis_ = x ? &Vec3::x : y ? &Vec3::y : &Vec3::z;
        if (axis_)
            normal_.*axis_ = across.*axis_ > 0.0 ? 1.0 : -1.0;
    }

    const Vec3 &normal() const { return normal_; }
    const Vec3 &origin() const { return origin_; }
    /// Signed distance.
    double height(const Vec3 &p) const { return dot(p - origin_, normal_); }
    /// The point of the plane nearest to p.
    Vec3 nearest(Vec3 p) const {
        if (axis_)
            p.*axis_ = origin_.*axis_;
        else
            p -= height(p) * normal_;
        return p;
    }

  private:
    Vec3 normal_, origin_;
    double Vec3::*axis_ = nullptr; // the coordinate that all its points share, if there is one
};

/// The plane of a patch's largest triangle, which is the best conditioned one (triangles of interfaces may wind either
/// way, so it is not that of their sum); how far the vertices go from its origin, and from it.
struct PatchPlane {
    Plane plane;
    double extent = 0.0;
    double off = 0.0;
};
PatchPlane plane_of(std::span<const Vec3> points, std::span<const Facet> triangles);

} // namespace wct::geometry
