#include "search/stratified_mesh.h"

#include "base/facet_uses.h"
#include "geometry/predicates.h"
#include "search/needle_cosines.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <unordered_set>

namespace wct::search {

namespace {

template <std::size_t n> std::string text(const std::array<int, n> &cell) {
    std::string out = "(";
    for (std::size_t k = 0; k < n; ++k)
        out += (k ? ", " : "") + std::to_string(cell[k]);
    return out + ")";
}

/// Edges of tets between ends of creases.
std::unordered_set<Edge, KeyHash> edges_between_creases(const StratifiedMesh &mesh) {
    std::vector<char> ends(mesh.points.size(), 0);
    for (const Edge &crease : mesh.creases)
        ends[crease[0]] = ends[crease[1]] = 1;
    std::unordered_set<Edge, KeyHash> edges;
    for (const Tet &tet : mesh.tets)
        for (const auto &edge : kEdges)
            if (ends[tet[edge[0]]] && ends[tet[edge[1]]])
                edges.insert(sorted(tet[edge[0]], tet[edge[1]]));
    return edges;
}

} // namespace

void expect_conforming(const StratifiedMesh &mesh) {
    const auto &points = mesh.points;
    const FacetUses uses(mesh.tets, points.size());
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const Tet &tet = mesh.tets[t];
        if (geometry::orient3d(points[tet[0]], points[tet[1]], points[tet[2]], points[tet[3]]) <= 0)
            throw std::invalid_argument("tet " + std::to_string(t) + " is inverted or flat");
        for (int i = 0; i < 4; ++i)
            if (const Facet key = sorted(inward_facet(tet, i)); uses.of(key).size() > 2)
                throw std::invalid_argument("tets: facet " + text(key) + " belongs to more than two");
    }
    std::unordered_set<Facet, KeyHash> given;
    for (const Facet &facet : mesh.facets) {
        const Facet key = sorted(facet);
        if (uses.of(key).empty())
            throw std::invalid_argument("facets: " + text(facet) + " is no facet of a tet");
        given.insert(key);
    }
    for (const Tet &tet : mesh.tets)
        for (int i = 0; i < 4; ++i) {
            const Facet key = sorted(inward_facet(tet, i));
            if (uses.of(key).size() == 1 && !given.contains(key))
                throw std::invalid_argument("facets: boundary facet " + text(key) + " is missing");
        }
    const auto edges = edges_between_creases(mesh);
    for (const Edge &crease : mesh.creases)
        if (!edges.contains(sorted(crease[0], crease[1])))
            throw std::invalid_argument("creases: " + text(crease) + " is no edge of a tet");
}

void expect_kept(const TetComplex &complex) {
    for (const auto &[facet, patch] : complex.sorted_surface())
        if (!complex.has_cell(facet))
            throw std::logic_error("the search lost facet " + text(facet) + " of patch " + std::to_string(patch));
    for (const auto &[edge, curve] : complex.creases())
        if (!complex.has_cell(edge))
            throw std::logic_error("the search lost edge " + text(edge) + " of curve " + std::to_string(curve));
}

TetComplex complex_of(const StratifiedMesh &mesh) {
    TetComplex complex;
    const auto needle = needle_cosines(mesh.points, mesh.tets, mesh.region, mesh.creases);
    for (std::size_t v = 0; v < mesh.points.size(); ++v) {
        const bool inside = mesh.stratum[v] == Stratum::interior;
        complex.add_vertex({mesh.points[v], mesh.stratum[v], inside ? -1 : mesh.label[v], mesh.size[v], needle[v]});
    }
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
        complex.add_tet(mesh.tets[t], mesh.region[t], 0.0);
    for (std::size_t k = 0; k < mesh.facets.size(); ++k) {
        const auto &[a, b, c] = mesh.facets[k];
        complex.add_facet(sorted(a, b, c), mesh.facet_patch[k]);
    }
    for (std::size_t k = 0; k < mesh.creases.size(); ++k)
        complex.add_crease(sorted(mesh.creases[k][0], mesh.creases[k][1]), mesh.crease_curve[k]);
    return complex;
}

StratifiedMesh mesh_of(const TetComplex &complex) {
    StratifiedMesh mesh;
    std::vector<int> place(complex.vertex_slots(), -1);
    for (std::size_t k = 0; k < complex.vertex_slots(); ++k) {
        const int v = static_cast<int>(k);
        if (!complex.used(v))
            continue;
        place[v] = static_cast<int>(mesh.points.size());
        const Vertex &vertex = complex.vertex(v);
        mesh.points.push_back(vertex.position);
        mesh.stratum.push_back(vertex.stratum);
        mesh.label.push_back(vertex.label);
        mesh.size.push_back(vertex.size);
    }
    for (std::size_t k = 0; k < complex.tet_slots(); ++k) {
        const int t = static_cast<int>(k);
        if (!complex.alive(t))
            continue;
        const auto &[a, b, c, d] = complex.tet(t);
        mesh.tets.push_back({place[a], place[b], place[c], place[d]});
        mesh.region.push_back(complex.region(t));
    }
    for (const auto &[key, patch] : complex.sorted_surface()) {
        mesh.facets.push_back({place[key[0]], place[key[1]], place[key[2]]});
        mesh.facet_patch.push_back(patch);
    }
    for (const auto &[key, curve] : complex.sorted_creases()) {
        mesh.creases.push_back({place[key[0]], place[key[1]]});
        mesh.crease_curve.push_back(curve);
    }
    return mesh;
}

std::vector<int> rows_of(const TetComplex &complex, const std::vector<int> &slots) {
    std::vector<int> rows;
    int row = 0;
    for (std::size_t k = 0; k < complex.tet_slots(); ++k) {
        const int t = static_cast<int>(k);
        if (!complex.alive(t))
            continue;
        if (std::binary_search(slots.begin(), slots.end(), t))
            rows.push_back(row);
        ++row;
    }
    return rows;
}

double mean_surface_size(const StratifiedMesh &mesh) {
    double sum = 0.0, count = 0.0;
    for (std::size_t v = 0; v < mesh.size.size(); ++v)
        if (mesh.stratum[v] != Stratum::interior) {
            sum += mesh.size[v];
            count += 1.0;
        }
    return count > 0.0 ? sum / count : 1.0;
}

} // namespace wct::search
