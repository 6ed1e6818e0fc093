#include "domain/region_map.h"

#include "base/random.h"
#include "support/bodies.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace wct::tests {

namespace {

Vec3 at(const domain::InputMesh &mesh, const domain::Place &place) {
    Vec3 x;
    for (int i = 0; i < 4; ++i)
        x += place.weight[i] * mesh.points[mesh.tets[place.tet][i]];
    return x;
}

} // namespace

TEST_CASE("RegionMap: regions of a cube of two, and where in the mesh a point is") {
    const Body body = cube(4, 0.3, 1, 0.25);
    const domain::InputMesh mesh = body.mesh();
    const domain::Reference reference(body.surface());
    const domain::RegionMap map(mesh, reference);
    Random random(1);
    for (int k = 0; k < 1000; ++k) {
        const Vec3 p{1.4 * random.uniform() - 0.2, 1.4 * random.uniform() - 0.2, 1.4 * random.uniform() - 0.2};
        const bool out = p.x < 0 || p.x > 1 || p.y < 0 || p.y > 1 || p.z < 0 || p.z > 1;
        const int wanted = out ? -1 : p.x > 0.25;
        REQUIRE(map.region(p, reference.nearest(p)) == wanted);
        REQUIRE(map.region(p, -1) == wanted);
        REQUIRE(map.region(p, random.below(static_cast<int>(body.facets.size()))) == wanted);
        const domain::Place place = map.find(p);
        REQUIRE((place.tet < 0) == out);
        const domain::Place near = map.find_or_nearest(p);
        REQUIRE(near.tet >= 0);
        const Vec3 nearest{std::clamp(p.x, 0.0, 1.0), std::clamp(p.y, 0.0, 1.0), std::clamp(p.z, 0.0, 1.0)};
        REQUIRE(norm(at(mesh, near) - nearest) < 1e-10);
        REQUIRE(*std::min_element(near.weight, near.weight + 4) > -1e-9);
        if (!out) {
            REQUIRE(place.tet == near.tet);
            REQUIRE(mesh.region[place.tet] == wanted);
        }
    }
}

TEST_CASE("RegionMap: between a coarse mesh and the surface that it stands for, the surface decides") {
    const Body coarse = ball(2, 0.0, 1), fine = ball(8, 0.0, 1);
    const domain::InputMesh mesh = coarse.mesh();
    const domain::Reference reference(fine.surface());
    const domain::RegionMap map(mesh, reference);
    Random random(2);
    int between = 0;
    for (int k = 0; k < 1000; ++k) {
        const Vec3 p = (0.8 + 0.4 * random.uniform()) * unit(random.normal3());
        const domain::Foot foot = reference.nearest(p);
        if (foot.distance < 0.03)
            continue;
        const bool inside = norm(p) < 1.0;
        between += inside && map.find(p).tet < 0;
        REQUIRE(map.region(p, foot) == (inside ? 0 : -1));
        REQUIRE(map.region(p, -1) == (inside ? 0 : -1));
    }
    CHECK(between > 20);
}

} // namespace wct::tests
