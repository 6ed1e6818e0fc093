#pragma once

#include "base/cells.h"
#include "base/random.h"
#include "domain/reference.h"
#include "domain/region_map.h"
#include "sampling/cloud.h"

#include <cstdint>
#include <span>
#include <vector>

namespace wct::conform {

/// A piece of a crease that has to be an edge of the mesh.
struct Segment {
    int a;
    int b;
    int curve;
};

/// The points of a mesh with the pieces of its creases: surface points stay where they are, or within their plane, and
/// more may be put between them. `reference` must outlive it.
class ConformingCloud {
  public:
    /// `stratum`, `label` per point of the mesh: its role, and the patch or curve. `reference` has the mesh's points.
    ConformingCloud(const domain::Reference &reference, const domain::InputMesh &mesh, std::span<const Stratum> stratum,
                    std::span<const int> label, std::span<const double> size);

    const sampling::Cloud &points() const { return cloud_; }
    const std::vector<Segment> &segments() const { return segments_; }
    /// Per point the mesh's own, -1 for new ones.
    const std::vector<int> &origin() const { return origin_; }

    /// Edge length at a point of the mesh.
    double size_of_own(int point) const { return size_[point]; }

    /// From here on points that come in keep their distance from each other and from those of the surface.
    void begin_round();
    /// Take interior points out.
    void remove(const std::vector<char> &gone);
    /// Move an interior point.
    void shift(int point, const Vec3 &by) { cloud_.points[point] += by; }
    /// Move a point of a planar patch to the place of its plane nearest to this one; false if another point is there.
    bool put_in_plane(int point, const Vec3 &near);
    /// Cut a segment in two: in the middle or, at a corner, on a sphere round it that all segments there share, so that
    /// the cuts of two that meet at a small angle do not call for each other for ever.
    bool split(std::size_t segment);
    /// A point of a patch as near to p as possible, or a cut of the crease there that would be too close to it.
    bool insert_on_patch(const Vec3 &p, int patch, double size, double apart);
    bool insert_inside(const Vec3 &p, int region, double size, double apart);

  private:
    static constexpr double kLeast = 0.01; // distance of points, in sizes of the input

    bool put(const Vec3 &p, Stratum role, int label, double size, double apart);

    /// A point of a patch, of its plane where it has one, nearest to this one.
    Vec3 on_patch(const Vec3 &near, int patch) const;

    const domain::Reference *reference_; // never null
    std::span<const double> size_;
    sampling::Cloud cloud_;
    std::vector<int> origin_;
    std::vector<Segment> segments_;
    sampling::PointGrid surface_;
    sampling::PointGrid fresh_;
};

} // namespace wct::conform
