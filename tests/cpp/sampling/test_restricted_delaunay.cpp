#include "sampling/restricted_delaunay.h"

#include "base/random.h"
#include "delaunay/delaunay.h"
#include "geometry/euler_characteristic.h"
#include "support/bodies.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace wct::tests {

namespace {

/// A cylinder cut in two at half its height: there is a rim on its smooth side.
Body drum() {
    const Body whole = cylinder(4, 0.0, 1);
    std::vector<int> regions;
    for (const Tet &tet : whole.tets) {
        double z = 0.0;
        for (const int v : tet)
            z += 0.25 * whole.points[v].z;
        regions.push_back(z < 0.5);
    }
    return stratified(whole.points, whole.tets, regions, [](const Vec3 &, const Vec3 &normal) {
        return std::abs(normal.z) < 0.5 ? 0 : normal.z < 0.0 ? 1 : 2;
    });
}

/// Is the edge on the boundary of the complex?
bool on_boundary(const sampling::RestrictedDelaunay &complex, int a, int b) {
    for (int t = 0; t < static_cast<int>(complex.all.tets.size()); ++t)
        for (int i = 0; i < 4; ++i)
            if (complex.region[t] >= 0 && complex.beyond(t, i) < 0) {
                const auto f = complex.facet(t, i);
                if (std::count(f.begin(), f.end(), a) && std::count(f.begin(), f.end(), b))
                    return true;
            }
    return false;
}

/// Tets with their neighbours.
delaunay::Triangulation joined(const std::vector<Tet> &tets) {
    delaunay::Triangulation out{tets, std::vector<std::array<int, 4>>(tets.size(), {-1, -1, -1, -1})};
    std::map<std::array<int, 3>, std::array<int, 2>> open;
    for (int t = 0; t < static_cast<int>(tets.size()); ++t)
        for (int i = 0; i < 4; ++i) {
            std::array<int, 3> facet{tets[t][kOutward[i][0]], tets[t][kOutward[i][1]], tets[t][kOutward[i][2]]};
            std::sort(facet.begin(), facet.end());
            const auto [other, fresh] = open.try_emplace(facet, std::array{t, i});
            if (!fresh) {
                out.neighbours[t][i] = other->second[0];
                out.neighbours[other->second[0]][other->second[1]] = t;
            }
        }
    return out;
}

} // namespace

TEST_CASE("Restricted Delaunay: tets that hide a rim are taken off") {
    const Body body = drum();
    const domain::Reference reference(body.surface());
    const domain::InputMesh mesh = body.mesh();
    const domain::RegionMap map(mesh, reference);
    const int rim = [&] {
        for (int c = 0; c < static_cast<int>(reference.curves().size()); ++c)
            if (reference.patches_at_curve(c).size() == 3)
                return c;
        return -1;
    }();
    REQUIRE(rim >= 0);
    // Two points of the rim, far apart, and between them two of the sides above and below, joined outside of the chord.
    sampling::Cloud cloud;
    const auto add = [&](const Vec3 &p, Stratum role) {
        const domain::Foot foot = reference.nearest(p);
        const int label = role == Stratum::crease  ? rim
                          : role == Stratum::patch ? body.patch[foot.triangle]
                                                   : (p.z < 0.5 ? 1 : 0);
        cloud.add(role == Stratum::patch ? foot.point : p, role, label, 0.3);
    };
    const double turn = 0.3;
    add({std::cos(turn), std::sin(turn), 0.5}, Stratum::crease);
    add({std::cos(turn), -std::sin(turn), 0.5}, Stratum::crease);
    add({1.0, 0.0, 0.78}, Stratum::patch);
    add({1.0, 0.0, 0.22}, Stratum::patch);
    add({0.4, 0.0, 0.75}, Stratum::interior);
    add({0.4, 0.0, 0.25}, Stratum::interior);
    const auto all = sampling::labelled_delaunay(cloud, map, Workers(1));
    const auto peeled = sampling::restricted_delaunay(cloud, reference, map, Workers(1));
    CHECK_FALSE(on_boundary(all, 0, 1));
    CHECK(on_boundary(all, 2, 3));
    CHECK(on_boundary(peeled, 0, 1));
    CHECK_FALSE(on_boundary(peeled, 2, 3));
}

TEST_CASE("Restricted Delaunay: Euler characteristics by the surface are those by all cells") {
    int smooth = 0, pinched = 0, handles = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        Random random(seed);
        const Body body = cube(6, 0.0, 1);
        sampling::Cloud cloud;
        for (const Vec3 &p : body.points)
            cloud.add(p, Stratum::interior, 0, 0.2);
        sampling::RestrictedDelaunay complex{joined(body.tets), {}, {}};
        for (const Tet &tet : complex.all.tets) {
            const Vec3 p = cloud.centroid(tet) - Vec3{0.5, 0.5, 0.5};
            const double round = std::max(std::abs(p.x), std::abs(p.y)); // round a column of whole cubes
            const bool hole = seed % 3 == 0 && round < 1.0 / 6.0, scattered = seed % 3 == 1 && random.uniform() < 0.01;
            complex.region.push_back(hole || scattered ? -1 : p.z > 1.0 / 6.0);
        }
        const sampling::Flaws flaws = sampling::find_flaws(cloud, complex);
        const std::vector<int> all = geometry::euler_characteristics(complex.all.tets, complex.region);
        CHECK(sampling::euler_characteristics(complex, flaws) == all);
        (flaws.pinched.empty() ? smooth : pinched) += 1;
        handles += flaws.pinched.empty() && all != std::vector<int>{1, 1};
    }
    CHECK(smooth > 10);
    CHECK(pinched > 5);
    CHECK(handles > 2);
}

} // namespace wct::tests
