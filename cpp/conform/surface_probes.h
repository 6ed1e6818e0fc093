#pragma once

#include "base/cells.h"
#include "base/vec3.h"
#include "domain/reference.h"

#include <optional>
#include <span>
#include <vector>

namespace wct::conform {

/// Tells where a new surface of a mesh leaves the old one, or the one given that both stand for, in either direction.
class SurfaceProbes {
  public:
    /// `most`: how far it may be off.
    SurfaceProbes(const domain::Reference &own, const std::optional<domain::Reference> &given, double most);

    /// Is a point of the new surface too far off? `foot`: of it on the own surface.
    bool off(const Vec3 &p, const domain::Foot &foot) const;
    /// Of the points of a new facet the farthest from the own surface among those too far off (`all`: among all); no
    /// triangle if there are none.
    domain::Foot farthest(const std::array<Vec3, 3> &corners, bool all) const;
    /// Points of the own surface that the new one misses by too much, at most one per triangle. `origin` per point of
    /// the new mesh: the own one, -1 for others.
    std::vector<domain::Foot> missed(std::span<const Vec3> points, std::span<const Facet> facets,
                                     std::span<const int> origin) const;
    bool is_own(Facet facet, std::span<const int> origin) const;

  private:
    struct Probe {
        domain::Foot foot; // on the own surface
        Vec3 at;           // the same or, where there is one, on the given surface
    };
    const domain::Reference &own_;
    const std::optional<domain::Reference> &given_;
    double most_;
    std::vector<Facet> facets_;              // the own, ascending corners, in order
    std::vector<int> triangle_;              // per entry of facets_
    std::vector<std::vector<Probe>> probes_; // per own triangle
};

} // namespace wct::conform
