#pragma once

#include "search/tet_complex.h"

#include <cstdint>
#include <string>
#include <vector>

namespace wct::tests {

/// All that a TetComplex holds, but for which slots are free: stars and landmarks in their order, hints too.
struct State {
    struct OfTet {
        int slot, region;
        Tet tet;
        double energy;
        bool operator==(const OfTet &) const = default;
    };
    struct OfFacet {
        Facet key;
        int patch;
        double over;
        search::SurfaceHints hints;
        std::vector<int> landmarks;
        bool operator==(const OfFacet &) const = default;
    };
    struct OfVertex {
        Vec3 position;
        Stratum stratum;
        int label;
        double size, needle;
        std::int32_t hint;
        std::vector<int> star;
        bool operator==(const OfVertex &) const = default;
    };
    std::vector<OfVertex> vertices;
    std::vector<OfTet> tets;
    std::vector<OfFacet> facets;
    std::vector<std::pair<Edge, int>> creases;
    std::size_t count, slots;
    double total;
    int over_count;

    explicit State(const search::TetComplex &complex);
    bool operator==(const State &) const = default;
};

/// The slots of the tets that are there.
std::vector<int> living(const search::TetComplex &complex);

/// Where two states differ first; empty where they are the same bits.
std::string difference(const State &before, const State &after);

/// What a mesh is, whatever its vertices and tets are numbered: the corners of tets, facets and creases by their
/// places, ascending, each followed by what else is known of it.
struct Content {
    std::vector<std::vector<double>> tets, facets, creases;

    explicit Content(const search::TetComplex &complex);
    bool operator==(const Content &) const = default;
};

/// What is wrong with a complex, found from its tets alone; empty where it is sound. Tets are positive, stars list
/// them, a facet is of one tet or of two that see it from opposite sides, one of a single tet or between two regions is
/// in the surface map, every surface facet is one of a tet and every crease an edge of one, edges where patches meet
/// are creases, and the sums and counts are those of the parts.
std::string fault(const search::TetComplex &complex);

/// Per region vertices - edges + facets - tets.
std::vector<int> characteristics(const search::TetComplex &complex);

/// An edge where other than two facets of a region's boundary meet, as where its surface pinches; empty: there is none.
std::string pinch(const search::TetComplex &complex);

/// Sum of the volumes of the tets of each region.
std::vector<double> volumes(const search::TetComplex &complex);

} // namespace wct::tests
