#pragma once

#include "base/cells.h"
#include "base/vec3.h"
#include "geometry/box_tree.h"

#include <span>

namespace wct::geometry {

/// Nearest points of triangles given by their corners' numbers. It looks at the caller's arrays: they must outlive it.
class TriangleTree {
  public:
    struct Nearest : TrianglePoint {
        int triangle = -1;
    };

    TriangleTree(std::span<const Vec3> points, std::span<const Facet> triangles);

    /// Sooner where `hint` is a triangle nearby; the answer does not depend on it. Any triangle will do whose squared
    /// distance is at most `enough`.
    Nearest nearest(const Vec3 &p, int hint = -1, double enough = -1.0) const;

  private:
    TrianglePoint nearest_on(int triangle, const Vec3 &p) const {
        const auto &[a, b, c] = triangles_[triangle];
        return nearest_on_triangle(p, points_[a], points_[b], points_[c]);
    }

    std::span<const Vec3> points_;
    std::span<const Facet> triangles_;
    BoxTree tree_;
    double scale_ = 0.0; // largest coordinate
};

} // namespace wct::geometry
