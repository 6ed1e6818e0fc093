#include "geometry/edge_table.h"

#include "support/bodies.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

namespace wct::tests {

TEST_CASE("EdgeTable: every edge once in the order of its ends, and those of each tet") {
    const Body body = ball(4, 0.2, 3);
    const geometry::EdgeTable table = geometry::edge_table(body.tets, body.points.size() + 3); // some without a tet
    std::set<Edge> edges;
    for (std::size_t t = 0; t < body.tets.size(); ++t)
        for (int k = 0; k < 6; ++k) {
            const Edge edge = sorted(body.tets[t][kEdges[k][0]], body.tets[t][kEdges[k][1]]);
            edges.insert(edge);
            REQUIRE(table.edges[table.of_tets[t][k]] == edge);
        }
    CHECK(table.edges == std::vector<Edge>(edges.begin(), edges.end()));
    CHECK(geometry::edge_table({}, 0).edges.empty());
}

} // namespace wct::tests
