#pragma once

#include "search/tet_complex.h"

#include <utility>
#include <vector>

namespace wct::search {

/// What happened to a complex, without the way there: of all that came, went and changed, what is left of it in the
/// end. Several threads work on copies of one mesh; what one of them has come to is done to all the others so.
struct MeshChange {
    struct NewTet {
        Tet tet;
        int region;
        double energy;
    };
    struct NewFacet {
        Facet key;
        int patch;
        double over;
        SurfaceHints hints;
    };

    std::vector<Vertex> vertices; // new ones, which the cells below number from first_vertex on
    int first_vertex = 0;
    std::vector<std::pair<int, Vec3>> moved;         // vertices, and where to
    std::vector<std::pair<int, std::int32_t>> hints; // of vertices
    std::vector<int> gone_tets;
    std::vector<NewTet> tets;
    std::vector<std::pair<int, double>> energies; // of tets that stay
    std::vector<Facet> gone_facets;
    std::vector<NewFacet> facets;
    std::vector<NewFacet> kept_facets; // those that stay but are over by another length, or near other pieces
    std::vector<std::pair<int, Facet>> landmarks; // and the facets that have got them
    std::vector<Edge> gone_creases;
    std::vector<std::pair<Edge, int>> creases;
    /// Vertices that were there before of all tets that went or are another shape or energy, ascending. Two changes
    /// that have none in common do not reach each other, and can be done one after the other.
    std::vector<int> touched;
};

} // namespace wct::search
