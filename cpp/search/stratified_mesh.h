#pragma once

#include "search/tet_complex.h"

#include <vector>

namespace wct::search {

/// A mesh that a search starts from, or has led to, as plain arrays.
struct StratifiedMesh {
    std::vector<Vec3> points;
    std::vector<Stratum> stratum; // per point
    std::vector<int> label;       // per point, as of Vertex
    std::vector<double> size;     // per point: edge length wanted there
    std::vector<Tet> tets;
    std::vector<int> region;      // per tet
    std::vector<Facet> facets;    // of the surface: the boundary, interfaces between regions, sheets
    std::vector<int> facet_patch; // per facet
    std::vector<Edge> creases;
    std::vector<int> crease_curve; // per crease
};

/// The tets are positive and conform; the facets are theirs, every boundary facet among them; so are the creases.
/// std::invalid_argument names what is not so.
void expect_conforming(const StratifiedMesh &mesh);

/// Every surface facet is a facet of a tet and every crease an edge of one. The operators keep it so: if not, the fault
/// is theirs, and what is lost is not to be lost silently: std::logic_error.
void expect_kept(const TetComplex &complex);

/// The mesh, to be changed; no energies are known yet.
TetComplex complex_of(const StratifiedMesh &mesh);

/// What a search has made of it: points and tets in the order of their slots, facets and creases in that of their keys.
StratifiedMesh mesh_of(const TetComplex &complex);

/// The rows that tets of the complex, given by slots in ascending order, have in mesh_of.
std::vector<int> rows_of(const TetComplex &complex, const std::vector<int> &slots);

/// Mean edge length wanted at the points of the surface: how far apart its vertices will be. 1 where it has none.
double mean_surface_size(const StratifiedMesh &mesh);

} // namespace wct::search
