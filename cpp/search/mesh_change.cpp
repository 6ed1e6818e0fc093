#include "search/mesh_change.h"

#include "base/sort_unique.h"

#include <map>
#include <set>

namespace wct::search {

/// What the journal names, each once, and of cells that come and go whether they were there at first.
struct TetComplex::Noted {
    std::vector<int> moved, hinted;  // vertices
    std::vector<int> gone, measured; // tets
    std::set<int> fresh;             // tets
    std::map<Facet, bool> facets;    // whether there at first
    std::map<Edge, bool> creases;    // the same
    std::vector<int> landmarks;      // handed on
    std::vector<int> place;          // of new vertices among those that are left, or -1
    int first_vertex = 0;

    /// A cell of vertices as a MeshChange numbers them.
    template <class Cell> Cell numbered(Cell cell) const {
        for (int &v : cell)
            v = v < first_vertex ? v : place[static_cast<std::size_t>(v - first_vertex)];
        return cell;
    }
};

TetComplex::Noted TetComplex::noted() const {
    Noted out;
    int added = 0;
    for (const Entry &entry : journal_) {
        switch (entry.kind) {
        case Kind::added_vertex:
            ++added;
            break;
        case Kind::moved:
            out.moved.push_back(entry.index);
            break;
        case Kind::set_hint:
            out.hinted.push_back(entry.index);
            break;
        case Kind::added_tet:
            out.fresh.insert(entry.index);
            break;
        case Kind::removed_tet:
            if (!out.fresh.contains(entry.index))
                out.gone.push_back(entry.index);
            break;
        case Kind::set_energy:
            out.measured.push_back(entry.index);
            break;
        case Kind::added_facet:
            out.facets.try_emplace(facet_of(entry), false);
            break;
        case Kind::removed_facet:
        case Kind::set_over:
        case Kind::set_hints:
            out.facets.try_emplace(facet_of(entry), true);
            break;
        case Kind::handed_landmark:
            out.landmarks.push_back(entry.index);
            break;
        case Kind::added_crease:
            out.creases.try_emplace(crease_of(entry), false);
            break;
        case Kind::removed_crease:
            out.creases.try_emplace(crease_of(entry), true);
            break;
        }
    }
    out.first_vertex = static_cast<int>(vertices_.size()) - added;
    for (std::vector<int> *each : {&out.moved, &out.hinted, &out.measured, &out.landmarks})
        sort_unique(*each);
    return out;
}

MeshChange TetComplex::change() const {
    MeshChange out;
    Noted found = noted();
    out.first_vertex = found.first_vertex;
    for (int v = out.first_vertex; v < static_cast<int>(vertices_.size()); ++v) {
        found.place.push_back(used(v) ? out.first_vertex + static_cast<int>(out.vertices.size()) : -1);
        if (used(v))
            out.vertices.push_back(vertices_[v]);
    }
    for (const int v : found.moved)
        if (v < out.first_vertex) {
            out.moved.push_back({v, vertices_[v].position});
            out.touched.push_back(v);
        }
    for (const int v : found.hinted)
        if (v < out.first_vertex)
            out.hints.push_back({v, vertices_[v].hint});
    for (const int l : found.landmarks)
        out.landmarks.push_back({l, found.numbered(landmarks_.owner(l))});
    change_tets(found, out);
    change_surface(found, out);
    sort_unique(out.touched);
    return out;
}

void TetComplex::change_tets(const Noted &found, MeshChange &out) const {
    const auto touch = [&](int t) {
        for (const int v : tets_[t])
            if (v < out.first_vertex)
                out.touched.push_back(v);
    };
    out.gone_tets = found.gone;
    for (const int t : found.gone)
        touch(t);
    for (const int t : found.fresh)
        if (alive(t))
            out.tets.push_back({found.numbered(tets_[t]), regions_[t], energies_[t]});
    for (const int t : found.measured)
        if (alive(t) && !found.fresh.contains(t)) {
            out.energies.push_back({t, energies_[t]});
            touch(t);
        }
}

void TetComplex::change_surface(const Noted &found, MeshChange &out) const {
    for (const auto &[key, was_there] : found.facets) {
        const auto at = surface_.find(key);
        if (at != surface_.end()) {
            const SurfaceFacet &facet = at->second;
            (was_there ? out.kept_facets : out.facets)
                .push_back({found.numbered(key), facet.patch, facet.over, facet.hints});
        } else if (was_there) {
            out.gone_facets.push_back(key);
        }
    }
    for (const auto &[key, was_there] : found.creases) {
        const auto at = creases_.find(key);
        if (at != creases_.end())
            out.creases.push_back({found.numbered(key), at->second});
        else if (was_there)
            out.gone_creases.push_back(key);
    }
}

std::vector<int> TetComplex::apply(const MeshChange &change) {
    mark();
    const int later = static_cast<int>(vertices_.size()) - change.first_vertex;
    const auto numbered = [&](auto cell) {
        for (int &v : cell)
            v += v < change.first_vertex ? 0 : later;
        return cell;
    };
    for (const Vertex &vertex : change.vertices)
        add_vertex(vertex);
    for (const auto &[v, position] : change.moved)
        move(v, position);
    for (const auto &[v, hint] : change.hints)
        set_hint(v, hint);
    for (const int t : change.gone_tets)
        remove_tet(t);
    for (const auto &[tet, region, energy] : change.tets)
        add_tet(numbered(tet), region, energy);
    for (const auto &[t, energy] : change.energies)
        set_energy(t, energy);
    for (const auto &facet : change.facets)
        add_facet(numbered(facet.key), facet.patch);
    for (const auto &facet : change.kept_facets) // it may have gone and come back, though seldom in another patch
        surface_.at(facet.key).patch = facet.patch;
    for (const auto *facets : {&change.facets, &change.kept_facets})
        for (const auto &[key, patch, over, hints] : *facets) {
            set_over(numbered(key), over);
            set_hints(numbered(key), hints);
        }
    for (const auto &[landmark, owner] : change.landmarks)
        hand_landmark(landmark, numbered(owner));
    for (const Facet &key : change.gone_facets)
        remove_facet(key);
    for (const Edge &key : change.gone_creases)
        remove_crease(key);
    for (const auto &[key, curve] : change.creases)
        add_crease(numbered(key), curve);
    std::vector<int> tets;
    changed(tets);
    WCT_CHECK(checks.did("apply");)
    commit();
    return tets;
}

} // namespace wct::search
