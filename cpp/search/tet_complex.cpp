#include "search/tet_complex.h"

#include "base/random.h"
#include "base/sort_unique.h"

#include <algorithm>
#include <iterator>

namespace wct::search {

std::size_t KeyHash::operator()(const Edge &key) const {
    return mix((static_cast<std::uint64_t>(key[0]) << 32) | static_cast<std::uint32_t>(key[1]));
}

std::size_t KeyHash::operator()(const Facet &key) const {
    return mix(mix((static_cast<std::uint64_t>(key[0]) << 32) | static_cast<std::uint32_t>(key[1])) +
               static_cast<std::uint32_t>(key[2]));
}

bool TetComplex::has(int t, int v) const {
    const Tet &tet = tets_[t];
    return tet[0] == v || tet[1] == v || tet[2] == v || tet[3] == v;
}

int TetComplex::across(int t, int a, int b, int c) const {
    for (int other : stars_[a])
        if (other != t && has(other, b) && has(other, c))
            return other;
    return -1;
}

const TetComplex::SurfaceFacet *TetComplex::surface_facet(int a, int b, int c) const {
    // Three surface vertices are rare inside, and the look-up is not free.
    if (vertices_[a].stratum == Stratum::interior || vertices_[b].stratum == Stratum::interior ||
        vertices_[c].stratum == Stratum::interior)
        return nullptr;
    const auto found = surface_.find(sorted(a, b, c));
    return found == surface_.end() ? nullptr : &found->second;
}

int TetComplex::patch_of(int a, int b, int c) const {
    const SurfaceFacet *found = surface_facet(a, b, c);
    return found ? found->patch : -1;
}

bool TetComplex::has_both_sides(const Facet &key) const {
    const auto &[a, b, c] = key;
    return std::ranges::count_if(stars_[a], [&](int t) { return has(t, b) && has(t, c); }) > 1;
}

bool TetComplex::ruled_out(int t) const {
    if (!any_ruled_out_)
        return false;
    const Tet &tet = tets_[t];
    return std::any_of(std::begin(kFacets), std::end(kFacets), [&](const auto &facet) {
        const SurfaceFacet *found = surface_facet(tet[facet[0]], tet[facet[1]], tet[facet[2]]);
        return found && found->ruled_out;
    });
}

void TetComplex::surface_at(int v, std::vector<SurfaceAt> &facets) const {
    facets.clear();
    if (vertices_[v].stratum == Stratum::interior)
        return;
    for (int t : stars_[v]) {
        const Tet &tet = tets_[t];
        for (int i = 0; i < 4; ++i) {
            if (tet[i] == v)
                continue;
            const Facet key = sorted(inward_facet(tet, i));
            const SurfaceFacet *facet = surface_facet(key[0], key[1], key[2]);
            if (facet && std::none_of(facets.begin(), facets.end(),
                                      [&](const SurfaceAt &known) { return same(known.key, key); }))
                facets.push_back({key, facet});
        }
    }
}

std::vector<std::pair<Facet, int>> TetComplex::sorted_surface() const {
    std::vector<std::pair<Facet, int>> facets;
    facets.reserve(surface_.size());
    for (const auto &[key, facet] : surface_)
        facets.push_back({key, facet.patch});
    std::sort(facets.begin(), facets.end());
    return facets;
}

std::vector<std::pair<Edge, int>> TetComplex::sorted_creases() const {
    std::vector<std::pair<Edge, int>> creases(creases_.begin(), creases_.end());
    std::sort(creases.begin(), creases.end());
    return creases;
}

void TetComplex::sort_worst_first(std::vector<int> &tets) const {
    std::sort(tets.begin(), tets.end(),
              [&](int a, int b) { return energies_[a] != energies_[b] ? energies_[a] > energies_[b] : a < b; });
}

double TetComplex::over(const Tet &tet) const {
    if (over_count_ == 0)
        return 0.0;
    double sum = 0.0;
    for (const auto &facet : kFacets) {
        const int a = tet[facet[0]], b = tet[facet[1]], c = tet[facet[2]];
        if (over_at_[a] == 0 || over_at_[b] == 0 || over_at_[c] == 0)
            continue;
        const auto found = surface_.find(sorted(a, b, c));
        if (found != surface_.end() && found->second.over > 0.0)
            sum += 1.0 + found->second.over;
    }
    return sum;
}

void TetComplex::set_over(const Facet &key, double over) {
    SurfaceFacet &facet = surface_.at(key);
    if (facet.over == over)
        return;
    note({.kind = Kind::set_over, .index = 0, .energy = facet.over, .key = {key[0], key[1], key[2]}});
    count_over(key, (over > 0.0) - (facet.over > 0.0));
    facet.over = over;
}

double TetComplex::farthest_over() const {
    double most = 0.0;
    for (const auto &[key, facet] : surface_)
        most = std::max(most, facet.over);
    return most;
}

void TetComplex::count_over(const Facet &key, int change) {
    over_count_ += change;
    for (int v : key)
        over_at_[v] += change;
}

void TetComplex::set_hint(int v, std::int32_t hint) {
    note({.kind = Kind::set_hint, .index = v, .key = {vertices_[v].hint}});
    vertices_[v].hint = hint;
}

void TetComplex::set_hints(const Facet &key, const SurfaceHints &hints) {
    SurfaceFacet &facet = surface_.at(key);
    if (!marks_.empty()) {
        note({.kind = Kind::set_hints, .index = 0, .key = {key[0], key[1], key[2]}});
        old_hints_.push_back(facet.hints);
    }
    facet.hints = hints;
}

void TetComplex::move_landmark(int landmark, const Facet &owner, int after) {
    landmarks_.disown(landmark, surface_.at(landmarks_.owner(landmark)).landmark);
    landmarks_.own(landmark, owner, surface_.at(owner).landmark, after);
}

void TetComplex::add_landmark(const std::optional<Facet> &owner) {
    const int landmark = landmarks_.add();
    if (owner)
        landmarks_.own(landmark, *owner, surface_.at(*owner).landmark);
}

void TetComplex::forget_landmarks() {
    landmarks_.clear();
    for (auto &[key, facet] : surface_)
        facet.landmark = -1;
}

void TetComplex::hand_landmark(int landmark, const Facet &owner) {
    const Facet &was = landmarks_.owner(landmark);
    if (was == owner)
        return;
    note({.kind = Kind::handed_landmark,
          .index = landmark,
          .key = {was[0], was[1], was[2], landmarks_.previous(landmark)}});
    move_landmark(landmark, owner, -1);
}

void TetComplex::put_facet(const Facet &key, int patch, double over) {
    surface_[key] = {patch, -1, over, {}, false};
    count_over(key, over > 0.0);
}

void TetComplex::drop_facet(const Facet &key) {
    const auto found = surface_.find(key);
    count_over(key, -(found->second.over > 0.0));
    surface_.erase(found);
}

int TetComplex::curve_of(int a, int b) const {
    if (vertices_[a].stratum < Stratum::crease || vertices_[b].stratum < Stratum::crease)
        return -1;
    const auto found = creases_.find(sorted(a, b));
    return found == creases_.end() ? -1 : found->second;
}

void TetComplex::note(Entry entry) {
    if (!marks_.empty())
        journal_.push_back(entry);
}

void TetComplex::link(int t) {
    for (int v : tets_[t])
        stars_[v].push_back(t);
    alive_[t] = 1;
    ++alive_count_;
    total_ += energies_[t];
}

void TetComplex::link(int t, const std::array<int, 4> &places) {
    link(t);
    for (int i = 0; i < 4; ++i) {
        auto &star = stars_[tets_[t][i]];
        std::swap(star[places[i]], star.back());
    }
}

std::array<int, 4> TetComplex::unlink(int t) {
    std::array<int, 4> places{};
    for (int i = 0; i < 4; ++i) {
        auto &star = stars_[tets_[t][i]];
        const auto at = std::find(star.begin(), star.end(), t);
        places[i] = static_cast<int>(at - star.begin());
        *at = star.back();
        star.pop_back();
    }
    alive_[t] = 0;
    --alive_count_;
    total_ -= energies_[t];
    return places;
}

int TetComplex::add_vertex(const Vertex &vertex) {
    vertices_.push_back(vertex);
    stars_.emplace_back();
    over_at_.emplace_back();
    note({.kind = Kind::added_vertex, .index = 0, .key = {}});
    return static_cast<int>(vertices_.size()) - 1;
}

void TetComplex::move(int v, const Vec3 &position) {
    note({.kind = Kind::moved, .index = v, .position = vertices_[v].position, .key = {}});
    vertices_[v].position = position;
}

int TetComplex::add_tet(const Tet &tet, int region, double energy) {
    int t = static_cast<int>(tets_.size());
    const bool fresh = free_.empty();
    if (fresh) {
        tets_.emplace_back();
        regions_.emplace_back();
        energies_.emplace_back();
        alive_.emplace_back();
    } else {
        t = free_.back();
        free_.pop_back();
    }
    tets_[t] = tet;
    regions_[t] = region;
    energies_[t] = energy;
    link(t);
    note({.kind = Kind::added_tet, .index = t, .key = {fresh}});
    return t;
}

void TetComplex::remove_tet(int t) {
    const std::array<int, 4> places = unlink(t);
    if (marks_.empty())
        free_.push_back(t);
    else // the slot keeps its contents until no rollback can ask for them
        note({.kind = Kind::removed_tet, .index = t, .key = places});
}

void TetComplex::set_energy(int t, double energy) {
    note({.kind = Kind::set_energy, .index = t, .energy = energies_[t], .key = {}});
    total_ += energy - energies_[t];
    energies_[t] = energy;
}

void TetComplex::add_facet(const Facet &key, int patch) {
    put_facet(key, patch, 0.0);
    note({.kind = Kind::added_facet, .index = patch, .key = {key[0], key[1], key[2]}});
}

void TetComplex::remove_facet(const Facet &key) {
    const SurfaceFacet &facet = surface_.at(key);
    if (!marks_.empty()) {
        note(
            {.kind = Kind::removed_facet, .index = facet.patch, .energy = facet.over, .key = {key[0], key[1], key[2]}});
        old_hints_.push_back(facet.hints);
    }
    drop_facet(key);
}

void TetComplex::add_crease(const Edge &key, int curve) {
    creases_[key] = curve;
    note({.kind = Kind::added_crease, .index = curve, .key = {key[0], key[1]}});
}

void TetComplex::remove_crease(const Edge &key) {
    const auto found = creases_.find(key);
    note({.kind = Kind::removed_crease, .index = found->second, .key = {key[0], key[1]}});
    creases_.erase(found);
}

void TetComplex::mark() {
    marks_.push_back({journal_.size(), total_});
    WCT_CHECK(checks.mark();)
}

void TetComplex::commit() {
    WCT_CHECK(checks.commit(*this);)
    marks_.pop_back();
    if (!marks_.empty())
        return;
    for (const Entry &entry : journal_)
        if (entry.kind == Kind::removed_tet)
            free_.push_back(entry.index);
    journal_.clear();
    old_hints_.clear();
}

void TetComplex::rollback() {
    WCT_CHECK(checks.rollback();)
    const Mark mark = marks_.back();
    marks_.pop_back();
    for (; journal_.size() > mark.entries; journal_.pop_back())
        undo(journal_.back());
    total_ = mark.total;
}

void TetComplex::undo(const Entry &entry) {
    switch (entry.kind) {
    case Kind::added_vertex:
        vertices_.pop_back();
        stars_.pop_back();
        over_at_.pop_back();
        break;
    case Kind::moved:
        vertices_[entry.index].position = entry.position;
        break;
    case Kind::added_tet:
        unlink(entry.index);
        if (entry.key[0]) { // the last slot: what came later is gone
            tets_.pop_back();
            regions_.pop_back();
            energies_.pop_back();
            alive_.pop_back();
        } else {
            free_.push_back(entry.index);
        }
        break;
    case Kind::removed_tet:
        link(entry.index, entry.key);
        break;
    case Kind::set_energy:
        energies_[entry.index] = entry.energy;
        break;
    case Kind::added_facet:
        drop_facet(facet_of(entry));
        break;
    case Kind::removed_facet:
        put_facet(facet_of(entry), entry.index, entry.energy);
        surface_.at(facet_of(entry)).hints = old_hints_.back();
        old_hints_.pop_back();
        break;
    case Kind::set_over: {
        double &over = surface_.at(facet_of(entry)).over;
        count_over(facet_of(entry), (entry.energy > 0.0) - (over > 0.0));
        over = entry.energy;
        break;
    }
    case Kind::set_hint:
        vertices_[entry.index].hint = entry.key[0];
        break;
    case Kind::set_hints:
        surface_.at(facet_of(entry)).hints = old_hints_.back();
        old_hints_.pop_back();
        break;
    case Kind::handed_landmark:
        move_landmark(entry.index, facet_of(entry), entry.key[3]);
        break;
    case Kind::added_crease:
        creases_.erase(crease_of(entry));
        break;
    case Kind::removed_crease:
        creases_[crease_of(entry)] = entry.index;
        break;
    }
}

void TetComplex::changed(std::vector<int> &tets) const {
    tets.clear();
    for (std::size_t k = marks_.back().entries; k < journal_.size(); ++k) {
        const Kind kind = journal_[k].kind;
        if (kind == Kind::added_tet || kind == Kind::removed_tet || kind == Kind::set_energy)
            tets.push_back(journal_[k].index);
    }
    sort_unique(tets);
}

void TetComplex::resum() {
    total_ = 0.0;
    for (std::size_t t = 0; t < tets_.size(); ++t)
        if (alive_[t])
            total_ += energies_[t];
}

} // namespace wct::search
