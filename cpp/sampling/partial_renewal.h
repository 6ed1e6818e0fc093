#pragma once

#include "domain/sizing.h"
#include "sampling/cloud.h"

#include <optional>
#include <span>
#include <vector>

namespace wct::sampling {

/// A partial restart: a mesh that came right nearly everywhere, to be made anew round the places where it did not.
///
/// Where the points stay the tets do: one that contains its circumcenter, among others that do, is Delaunay (Rajan,
/// "Optimality of the Delaunay triangulation in R^d", 1994).
class PartialRenewal {
  public:
    struct Zone {
        Vec3 at;
        double radius; // within it all points are new
    };

    /// `mesh`: its points; corners that it leaves out stay where the surface has them.
    PartialRenewal(Cloud mesh, std::span<const Zone> zones);

    /// Put the mesh's own points in place of the cloud's outside the zones, and on wires and flat rims with corners of
    /// their own. These nothing moves, others beside the zones may, so that old and new ones find together.
    void apply(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing) const;
    /// Whether a ball reaches into a zone.
    bool reaches(const Vec3 &center, double radius) const { return within(center, 1.0, radius); }
    /// Take the points out of the cloud that are too far from all zones to be neighbours of one that may move.
    Cloud split_far(Cloud &cloud) const;

  private:
    /// Whether p is within this many radii, and this much more, of a zone.
    bool within(const Vec3 &p, double radii, double more) const;

    Cloud mesh_;
    std::vector<Zone> zones_;
};

/// Whether points are wanted in a ball: everywhere, or where a renewal makes them anew.
inline bool wanted(const std::optional<PartialRenewal> &renewal, const Vec3 &center, double radius = 0.0) {
    return !renewal || renewal->reaches(center, radius);
}

} // namespace wct::sampling
