#include "conform/circumspheres.h"

#include "delaunay/corners.h"

#include <array>

namespace wct::conform {

void Circumspheres::measure() {
    spheres_.clear();
    for (const auto &[a, b, c, d] : complex_.all.tets)
        spheres_.push_back(
            geometry::circumsphere(cloud_.points[a], cloud_.points[b], cloud_.points[c], cloud_.points[d]));
}

double Circumspheres::height(int t, int i) const {
    const auto &[a, b, c] = complex_.facet(t, i);
    const std::array<Vec3, 3> at{cloud_.points[a], cloud_.points[b], cloud_.points[c]};
    return dot(unit(normal_of(at)), at[0] - spheres_[t].center);
}

bool Circumspheres::tied(int t, int i, double least) const {
    const int next = complex_.all.neighbours[t][i];
    const int back = delaunay::place_of(complex_.all.neighbours[next], t);
    return !(height(t, i) + height(next, back) > least * 0.5 * (spheres_[t].radius + spheres_[next].radius));
}

} // namespace wct::conform
