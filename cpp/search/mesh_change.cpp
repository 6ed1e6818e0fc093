#include "search/mesh_change.h"

#include "base/sort_unique.h"

#include <map>
#include <set>

namespace wct::search {

namespace {

/// Of cells that come and go, whether each was there at first.
template <class Key> using WasThere = std::map<Key, bool>;

} // namespace

MeshChange TetComplex::change() const {
    MeshChange out;
    std::vector<int> moved, hinted, measured;
    std::set<int> fresh; // tets
    WasThere<Facet> facets;
    WasThere<Edge> creases;
    std::vector<int> landmarks;
    int added = 0;
    for (const Entry &entry : journal_) {
        switch (entry.kind) {
        case Kind::added_vertex:
            ++added;
            break;
        case Kind::moved:
            moved.push_back(entry.index);
            break;
        case Kind::set_hint:
            hinted.push_back(entry.index);
            break;
        case Kind::added_tet:
            fresh.insert(entry.index);
            break;
        case Kind::removed_tet:
            if (!fresh.contains(entry.index))
                out.gone_tets.push_back(entry.index);
            break;
        case Kind::set_energy:
            measured.push_back(entry.index);
            break;
        case Kind::added_facet:
            facets.try_emplace(facet_of(entry), false);
            break;
        case Kind::removed_facet:
        case Kind::set_over:
        case Kind::set_hints:
            facets.try_emplace(facet_of(entry), true);
            break;
        case Kind::handed_landmark:
            landmarks.push_back(entry.index);
            break;
        case Kind::added_crease:
            creases.try_emplace(crease_of(entry), false);
            break;
        case Kind::removed_crease:
            creases.try_emplace(crease_of(entry), true);
            break;
        }
    }
    out.first_vertex = static_cast<int>(vertices_.size()) - added;
    for (std::vector<int> *each : {&moved, &hinted, &measured, &landmarks})
        sort_unique(*each);

    std::vector<int> place(static_cast<std::size_t>(added), -1); // of new vertices, without those that are gone again
    for (int k = 0; k < added; ++k)
        if (const int v = out.first_vertex + k; used(v)) {
            place[k] = out.first_vertex + static_cast<int>(out.vertices.size());
            out.vertices.push_back(vertices_[v]);
        }
    const auto numbered = [&](auto cell) {
        for (int &v : cell)
            v = v < out.first_vertex ? v : place[v - out.first_vertex];
        return cell;
    };
    const auto touch = [&](int t) {
        for (const int v : tets_[t])
            if (v < out.first_vertex)
                out.touched.push_back(v);
    };
    for (const int v : moved)
        if (v < out.first_vertex) {
            out.moved.push_back({v, vertices_[v].position});
            out.touched.push_back(v);
        }
    for (const int v : hinted)
        if (v < out.first_vertex)
            out.hints.push_back({v, vertices_[v].hint});
    for (const int t : out.gone_tets)
        touch(t);
    for (const int t : fresh)
        if (alive(t))
            out.tets.push_back({numbered(tets_[t]), regions_[t], energies_[t]});
    for (const int t : measured)
        if (alive(t) && !fresh.contains(t)) {
            out.energies.push_back({t, energies_[t]});
            touch(t);
        }
    for (const auto &[key, was_there] : facets) {
        const auto found = surface_.find(key);
        if (found == surface_.end()) {
            if (was_there)
                out.gone_facets.push_back(key);
            continue;
        }
        const SurfaceFacet &facet = found->second;
        (was_there ? out.kept_facets : out.facets).push_back({numbered(key), facet.patch, facet.over, facet.hints});
    }
    for (const int l : landmarks)
        out.landmarks.push_back({l, numbered(landmarks_.owner(l))});
    for (const auto &[key, was_there] : creases) {
        const auto found = creases_.find(key);
        if (found != creases_.end())
            out.creases.push_back({numbered(key), found->second});
        else if (was_there)
            out.gone_creases.push_back(key);
    }
    sort_unique(out.touched);
    return out;
}

void TetComplex::apply(const MeshChange &change) {
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
}

} // namespace wct::search
