#include "sampling/seed_curves.h"

#include "support/bodies.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace wct::tests {

namespace {

/// Where the points are on the edges of a unit cube at z = 0 that run along y: those at this x, ascending.
std::vector<double> stops_along_y(const sampling::Cloud &cloud, double x) {
    std::vector<double> stops;
    for (std::size_t i = 0; i < cloud.count(); ++i) {
        const Vec3 &p = cloud.points[i];
        if (cloud.role[i] == Stratum::crease && std::fabs(p.x - x) < 1e-9 && p.z < 1e-9 && p.y > 1e-9 && p.y < 1 - 1e-9)
            stops.push_back(p.y);
    }
    std::sort(stops.begin(), stops.end());
    return stops;
}

sampling::Cloud curve_points(const Body &body) {
    const domain::InputMesh mesh = body.mesh();
    const domain::Reference reference(body.surface());
    const domain::RegionMap map(mesh, reference);
    domain::SizingForm form;
    form.tolerance = 1e-3;
    const std::vector<double> wanted(body.points.size(), 0.2);
    const domain::Sizing sizing(reference, mesh, map, form, wanted, Workers(1));
    sampling::Cloud cloud;
    sampling::seed_curves(cloud, reference, sizing);
    return cloud;
}

} // namespace

TEST_CASE("seed_curves: along a thin layer points lie opposite the middles between those of its other side") {
    constexpr int cells = 16;
    constexpr double layer = 1.0 / cells;
    const Body body = cube(cells, 0.0, 1, layer);
    const sampling::Cloud cloud = curve_points(body);
    const std::vector<double> outer = stops_along_y(cloud, 0.0), inner = stops_along_y(cloud, layer);
    REQUIRE(outer.size() > 8);
    CHECK(std::max(outer.size(), inner.size()) == std::min(outer.size(), inner.size()) + 1); // half a step at both ends
    const std::vector<double> &more = outer.size() > inner.size() ? outer : inner;
    const std::vector<double> &fewer = outer.size() > inner.size() ? inner : outer;
    for (std::size_t k = 0; k < fewer.size(); ++k) {
        const double along = (fewer[k] - more[k]) / (more[k + 1] - more[k]);
        CHECK(along > 0.3); // sizes grow along both, so not at the half
        CHECK(along < 0.7);
    }
}

TEST_CASE("seed_curves: along a thick layer they need not") {
    const sampling::Cloud cloud = curve_points(cube(4, 0.0, 1, 0.25));
    CHECK(stops_along_y(cloud, 0.0).size() == stops_along_y(cloud, 0.25).size());
}

} // namespace wct::tests
