#include "geometry/triangle_edges.h"

#include "support/bodies.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

namespace wct::tests {

TEST_CASE("TriangleEdges: every edge once, and by its ends the triangles that have both") {
    const Body body = cube(4, 0.1, 2, 0.5); // two regions: interfaces end at edges of three facets
    const geometry::TriangleEdges edges(body.facets);
    CHECK(std::is_sorted(edges.edges().begin(), edges.edges().end()));
    std::size_t sides = 0;
    for (std::size_t e = 0; e < edges.count(); ++e) {
        const Edge &edge = edges.edges()[e];
        std::vector<int> wanted;
        for (std::size_t t = 0; t < body.facets.size(); ++t) {
            const Facet &f = body.facets[t];
            if (std::find(f.begin(), f.end(), edge[0]) != f.end() && std::find(f.begin(), f.end(), edge[1]) != f.end())
                wanted.push_back(static_cast<int>(t));
        }
        const auto owners = edges.owners(edge);
        CHECK(std::vector<int>(owners.begin(), owners.end()) == wanted);
        CHECK(edges.first(e) == wanted.front());
        CHECK(edges.last(e) == wanted.back());
        CHECK(edges.paired(e) == (wanted.size() == 2));
        sides += owners.size();
    }
    CHECK(sides == 3 * body.facets.size());
    CHECK(edges.owners(Edge{0, 0}).empty());
    CHECK(edges.owners(Edge{0, static_cast<int>(body.points.size())}).empty());
}

} // namespace wct::tests
