#include "geometry/plane.h"

#include <cmath>

namespace wct::geometry {

PatchPlane plane_of(std::span<const Vec3> points, std::span<const Facet> triangles) {
    PatchPlane found;
    double largest = -1.0;
    for (const auto &[a, b, c] : triangles) {
        const Vec3 n = cross(points[b] - points[a], points[c] - points[a]);
        if (norm(n) > largest) {
            largest = norm(n);
            found.plane = {n, points[a]};
        }
    }
    for (const auto &triangle : triangles)
        for (const int v : triangle) {
            found.extent = std::max(found.extent, norm(points[v] - found.plane.origin()));
            found.off = std::max(found.off, std::abs(found.plane.height(points[v])));
        }
    return found;
}

} // namespace wct::geometry
