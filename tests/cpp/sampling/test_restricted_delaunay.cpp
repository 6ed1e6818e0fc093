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

/// Tets that rest on the surface alone, two facets of them or more outside, with a corner on a side of the other
/// region.
int lying_on_rims(const sampling::Cloud &cloud, const domain::Reference &reference,
                  const sampling::RestrictedDelaunay &complex) {
    int count = 0;
    for (int t = 0; t < static_cast<int>(complex.all.tets.size()); ++t) {
        const Tet &tet = complex.all.tets[t];
        const auto inside = [&](int v) { return cloud.role[v] == Stratum::interior; };
        if (complex.region[t] < 0 || std::any_of(tet.begin(), tet.end(), inside))
            continue;
        int outside = 0;
        for (int i = 0; i < 4; ++i)
            outside += complex.beyond(t, i) < 0;
        count += outside > 1 && std::any_of(tet.begin(), tet.end(), [&](int v) {
                     return cloud.role[v] == Stratum::patch &&
                            reference.sides(cloud.label[v])[0] != complex.region[t] &&
                            reference.sides(cloud.label[v])[1] != complex.region[t];
                 });
    }
    return count;
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
    const Body body = drum(4);
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

TEST_CASE("Restricted Delaunay: no tet lies on the rim of an interface, with corners on both sides of it") {
    const Body body = drum(8);
    const domain::Reference reference(body.surface());
    const domain::InputMesh mesh = body.mesh();
    const domain::RegionMap map(mesh, reference);
    int before = 0;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        Random random(seed);
        sampling::Cloud cloud; // the middles of the rim's edges, and the body's points elsewhere
        for (std::size_t e = 0; e < body.creases.size(); ++e) {
            const auto &[v, w] = body.creases[e];
            if (body.points[v].z == 0.5 && body.points[w].z == 0.5)
                cloud.add(0.5 * (body.points[v] + body.points[w]), Stratum::crease, body.curve[e], 0.2);
        }
        for (std::size_t v = 0; v < body.points.size(); ++v) {
            const Vec3 &p = body.points[v];
            const bool near = std::hypot(p.x, p.y) > 0.9 && std::abs(p.z - 0.5) < 0.2; // the rim
            if (!near)
                cloud.add(p, body.stratum[v], body.stratum[v] == Stratum::interior ? p.z < 0.5 : body.label[v], 0.2);
        }
        for (int k = 0; k < 64; ++k) { // on the side, just above and below the rim
            const double turn = 2.0 * std::acos(-1.0) * random.uniform(), lift = 0.04 + 0.1 * random.uniform();
            const domain::Foot foot = reference.nearest({std::cos(turn), std::sin(turn), 0.5 + (k % 2 ? lift : -lift)});
            cloud.add(foot.point, Stratum::patch, body.patch[foot.triangle], 0.2);
        }
        before += lying_on_rims(cloud, reference, sampling::labelled_delaunay(cloud, map, Workers(1)));
        CHECK(lying_on_rims(cloud, reference, sampling::restricted_delaunay(cloud, reference, map, Workers(1))) == 0);
    }
    CHECK(before > 0);
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
