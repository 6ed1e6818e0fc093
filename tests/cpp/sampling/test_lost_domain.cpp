#include "sampling/lost_domain.h"

#include "support/bodies.h"

#include <doctest/doctest.h>

#include <set>
#include <vector>

namespace wct::tests {

TEST_CASE("strange_contacts: where regions meet that no patch parts, as through a layer that is missing") {
    // Three slabs, cut at x = 1/4 and x = 1/2.
    Body body = cube(4, 0.0, 1);
    for (std::size_t t = 0; t < body.tets.size(); ++t) {
        double middle = 0.0;
        for (const int v : body.tets[t])
            middle += 0.25 * body.points[v].x;
        body.regions[t] = middle < 0.25 ? 0 : middle < 0.5 ? 1 : 2;
    }
    body = stratified(body.points, body.tets, body.regions, facing);
    const domain::Reference reference(body.surface());
    const domain::InputMesh mesh = body.mesh();
    const domain::RegionMap map(mesh, reference);
    sampling::Cloud cloud;
    for (std::size_t v = 0; v < body.points.size(); ++v) {
        const bool inside = body.stratum[v] == Stratum::interior;
        cloud.add(body.points[v], body.stratum[v], inside ? 2 : body.label[v], 0.25); // all of them are in the third
    }

    sampling::RestrictedDelaunay complex = sampling::restricted_delaunay(cloud, reference, map, Workers(1));
    CHECK(sampling::strange_contacts(complex, reference).empty());

    for (int &region : complex.region)
        region = region == 1 ? 2 : region;
    const std::vector<int> lost = sampling::strange_contacts(complex, reference);
    std::set<int> first;
    for (std::size_t v = 0; v < cloud.count(); ++v)
        if (cloud.points[v].x == 0.25)
            first.insert(static_cast<int>(v));
    CHECK(std::set<int>(lost.begin(), lost.end()) == first);
}

} // namespace wct::tests
