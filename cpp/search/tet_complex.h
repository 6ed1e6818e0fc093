#pragma once

#include "base/cells.h"
#include "base/vec3.h"
#include "geometry/landmark_owners.h"
#include "search/checks.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

namespace wct::search {

/// Of the keys under which creases and surface facets are found: their vertices in ascending order.
struct KeyHash {
    std::size_t operator()(const Edge &key) const;
    std::size_t operator()(const Facet &key) const;
};

/// Whether two keys are equal: == of arrays calls memcmp, which takes longer for three numbers.
inline bool same(const Facet &a, const Facet &b) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}
struct SameKey {
    bool operator()(const Facet &a, const Facet &b) const { return same(a, b); }
};

/// Pieces of the surface that parts of a facet were last found near: where to look first. Near two sheets of the
/// surface it may depend on them which one is found.
using SurfaceHints = std::array<std::int32_t, 10>;

struct MeshChange;

struct Vertex {
    Vec3 position;
    Stratum stratum = Stratum::interior;
    int label = -1;    // patch, curve or point of the surface that it stays on; -1: none, or a corner that is pinned
    double size = 0.0; // edge length wanted here
    /// Cosine above which angles of the tets here are like needles: those below 25.8 degrees, but at a crease that is
    /// as sharp itself.
    double needle = 0.9;
    std::int32_t hint = 0; // piece of its patch or curve that it was last found near, like SurfaceHints
};

/// A tetrahedral mesh under change. Surface facets (the boundary and the interfaces between regions) know their patch,
/// crease edges their curve. Every change is written to a journal while a mark is set; `rollback` returns to the last
/// mark, to the order of stars and the numbers that what comes next will get, so that the same is done from there as if
/// nothing had been; `commit` forgets the mark and keeps the changes (for the mark around it to undo, if there is one).
class TetComplex {
  public:
    std::size_t vertex_slots() const { return vertices_.size(); }
    std::size_t tet_slots() const { return tets_.size(); }
    /// How many tets are alive.
    std::size_t tets() const { return alive_count_; }

    const Vertex &vertex(int v) const { return vertices_[v]; }
    const Vec3 &point(int v) const { return vertices_[v].position; }
    bool used(int v) const { return !stars_[v].empty(); }
    /// Tets at v, in no particular order (but the same one for the same history).
    const std::vector<int> &star(int v) const { return stars_[v]; }

    bool alive(int t) const { return alive_[t] != 0; }
    const Tet &tet(int t) const { return tets_[t]; }
    Vec3 centroid(int t) const {
        const Tet &tet = tets_[t];
        return 0.25 * (point(tet[0]) + point(tet[1]) + point(tet[2]) + point(tet[3]));
    }
    int region(int t) const { return regions_[t]; }
    double energy(int t) const { return energies_[t]; }
    /// Largest energy first, ties by number.
    void sort_worst_first(std::vector<int> &tets) const;
    /// Sum over the living tets, kept up to date.
    double total() const { return total_; }
    bool has(int t, int v) const;
    /// Whether a tet has all of these vertices, as those of an edge or facet.
    template <class Cell> bool has_cell(const Cell &cell) const {
        const std::vector<int> &star = stars_[cell[0]];
        return std::any_of(star.begin(), star.end(), [&](int t) {
            return std::all_of(cell.begin(), cell.end(), [&](int v) { return has(t, v); });
        });
    }
    /// The tet across facet {a, b, c} of t, or -1.
    int across(int t, int a, int b, int c) const;

    struct SurfaceFacet {
        int patch = -1;
        int landmark = -1; // first of the surface's landmarks that it covers
        double over = 0.0; // how far it and its landmarks are apart beyond the tolerance, in tolerances
        SurfaceHints hints{};
        bool ruled_out = false;
    };
    /// Patch of a surface facet, -1 for an interior one.
    int patch_of(int a, int b, int c) const;
    bool is_surface(int a, int b, int c) const { return surface_facet(a, b, c) != nullptr; }
    /// Whether there are tets on both sides of a facet, as at interfaces and sheets.
    bool has_both_sides(const Facet &key) const;
    /// Surface facets at v, each once.
    struct SurfaceAt {
        Facet key;
        const SurfaceFacet *facet;
    };
    void surface_at(int v, std::vector<SurfaceAt> &facets) const;
    const SurfaceFacet &facet(const Facet &key) const { return surface_.at(key); }
    /// Sum of 1 + over for the tet's facets that are beyond the tolerance.
    double over(const Tet &tet) const;
    double over(const Facet &key) const { return surface_.at(key).over; }
    void set_over(const Facet &key, double over);
    /// How many facets are beyond the tolerance.
    int over_count() const { return over_count_; }
    /// How far the farthest of them is beyond it, in tolerances; 0 where none is.
    double farthest_over() const;
    /// The same of those at v.
    int over_at(int v) const { return over_at_[v]; }
    void set_hint(int v, std::int32_t hint);
    void set_hints(const Facet &key, const SurfaceHints &hints);
    /// Note that no tet on a surface facet, which must stay for ever, can meet the goal; whether t has such a facet.
    void rule_out(const Facet &key) {
        surface_.at(key).ruled_out = true;
        any_ruled_out_ = true;
    }
    bool ruled_out(int t) const;
    /// Landmarks of the surface, each owned by the facet that covers it: the one after, or -1.
    int next_landmark(int landmark) const { return landmarks_.next(landmark); }
    const Facet &landmark_owner(int landmark) const { return landmarks_.owner(landmark); }
    /// A new landmark (the next number), and a change of its owner. Both facets must be there, and a facet must have
    /// handed on its landmarks before it is removed.
    void add_landmark(const std::optional<Facet> &owner);
    void forget_landmarks();
    void hand_landmark(int landmark, const Facet &owner);
    /// The surface facets and their patches, in the order of their keys: that of the hash table means nothing.
    std::vector<std::pair<Facet, int>> sorted_surface() const;
    std::array<Vec3, 3> corners(const Facet &key) const { return {point(key[0]), point(key[1]), point(key[2])}; }
    /// Curve of a crease edge, -1 for any other.
    int curve_of(int a, int b) const;
    bool is_crease(int a, int b) const { return curve_of(a, b) >= 0; }
    const std::unordered_map<Edge, int, KeyHash> &creases() const { return creases_; }
    /// The creases and their curves, in the order of their keys.
    std::vector<std::pair<Edge, int>> sorted_creases() const;

    int add_vertex(const Vertex &vertex);
    void move(int v, const Vec3 &position);
    int add_tet(const Tet &tet, int region, double energy);
    void remove_tet(int t);
    void set_energy(int t, double energy);
    void add_facet(const Facet &key, int patch);
    void remove_facet(const Facet &key);
    void add_crease(const Edge &key, int curve);
    void remove_crease(const Edge &key);

    void mark();
    void commit();
    void rollback();
    /// Change of `total()` since the last mark.
    double gain() const { return total_ - marks_.back().total; }
    /// Tets added, removed or measured anew since the last mark, each once, in ascending order.
    void changed(std::vector<int> &tets) const;
    /// All that has changed since the only mark.
    MeshChange change() const;
    /// Do to this mesh what was done to another that was the same, or differed only where the change does not reach.
    /// Returns the tets added, removed or measured anew, as `changed` does. No rollback undoes it.
    std::vector<int> apply(const MeshChange &change);
    /// Recompute the sum from scratch: rounding in `total()` does not pile up over long runs.
    void resum();

    WCT_CHECK(CommitChecks checks;)

  private:
    enum class Kind : std::uint8_t {
        added_vertex,
        moved,
        added_tet,
        removed_tet,
        set_energy,
        added_facet,
        removed_facet,
        set_over,
        set_hint,
        set_hints,
        handed_landmark,
        added_crease,
        removed_crease
    };
    struct Entry {
        Kind kind;
        int index;              // vertex or tet; patch or curve of a facet or crease; landmark
        double energy = 0.0;    // before; how far over the facet was
        Vec3 position = {};     // before
        std::array<int, 4> key; // facet, then the landmark's place in its list; crease; places of a tet in stars; hint
    };
    static Facet facet_of(const Entry &entry) { return {entry.key[0], entry.key[1], entry.key[2]}; }
    static Edge crease_of(const Entry &entry) { return {entry.key[0], entry.key[1]}; }
    struct Mark {
        std::size_t entries;
        double total;
    };

    void note(Entry entry);
    /// The surface facet with these corners, nullptr where there is none.
    const SurfaceFacet *surface_facet(int a, int b, int c) const;
    void count_over(const Facet &key, int change);
    void put_facet(const Facet &key, int patch, double over);
    void drop_facet(const Facet &key);
    /// `after`: the landmark that it comes after in the list of the owner; -1: it is the first.
    void move_landmark(int landmark, const Facet &owner, int after);
    /// Returns the places that the tet had in the stars of its vertices.
    std::array<int, 4> unlink(int t);
    void link(int t);
    /// The same at these places, which unlink gave.
    void link(int t, const std::array<int, 4> &places);
    void undo(const Entry &entry);
    /// What the journal tells, for change().
    struct Noted;
    Noted noted() const;
    void change_tets(const Noted &found, MeshChange &out) const;
    void change_surface(const Noted &found, MeshChange &out) const;

    std::vector<Vertex> vertices_;
    std::vector<std::vector<int>> stars_;
    std::vector<Tet> tets_;
    std::vector<int> regions_;
    std::vector<double> energies_;
    std::vector<std::uint8_t> alive_;
    std::vector<int> free_; // dead slots nobody can ask back
    std::unordered_map<Facet, SurfaceFacet, KeyHash, SameKey> surface_;
    bool any_ruled_out_ = false;
    std::vector<int> over_at_; // per vertex: its facets beyond the tolerance
    int over_count_ = 0;
    geometry::LandmarkOwners<Facet> landmarks_;
    std::unordered_map<Edge, int, KeyHash> creases_;
    std::size_t alive_count_ = 0;
    double total_ = 0.0;
    std::vector<Entry> journal_;
    std::vector<SurfaceHints> old_hints_; // of the facets whose hints were set, or that were removed, in that order
    std::vector<Mark> marks_;
};

} // namespace wct::search
