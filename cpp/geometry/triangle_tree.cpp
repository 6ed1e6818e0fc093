#include "geometry/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace wct::geometry {

TriangleTree::TriangleTree(std::span<const Vec3> points, std::span<const Facet> triangles)
    : points_(points), triangles_(triangles) {
    std::vector<Box> boxes(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (const int v : triangles[t])
            boxes[t].add(points[v]);
    tree_ = BoxTree(boxes);
    for (const Box &box : boxes)
        for (const Vec3 &p : {box.lo, box.hi})
            scale_ = std::max({scale_, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
}

TriangleTree::Nearest TriangleTree::nearest(const Vec3 &p, int hint, double enough) const {
    // The hint only says how near the answer must be: of equally near triangles the first in the tree is the answer.
    double most = std::numeric_limits<double>::infinity();
    if (hint >= 0) {
        const TrianglePoint at = nearest_on(hint, p);
        if (at.square <= enough)
            return {at, hint};
        most = with_room(at.square, scale_);
    }
    Nearest found;
    tree_.minimise(
        most, [&](std::size_t node) { return tree_.box(node).square(p); },
        [&](std::size_t item, double best) {
            const TrianglePoint at = nearest_on(static_cast<int>(item), p);
            if (at.square < best)
                found = {at, static_cast<int>(item)};
            return at.square <= enough ? 0.0 : at.square; // nothing is nearer than that
        });
    return found;
}

} // namespace wct::geometry
