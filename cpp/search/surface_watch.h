#pragma once

#include "search/surface_guide.h"
#include "search/tet_complex.h"

#include <array>
#include <cstddef>
#include <vector>

namespace wct::search {

/// Keeps the surface facets of a complex and the surface they stand for within the tolerance of each other, both ways,
/// while facets move or are replaced: the facets by where they are, the surface by its landmarks, each of which is
/// owned by a facet that covers it. A facet that was beyond the tolerance from the start may stay so, but not get
/// farther. Nor does the surface come to bend as creases do where there is none: within a wide tolerance it could.
class SurfaceWatch {
  public:
    SurfaceWatch(TetComplex &complex, const SurfaceGuide &guide) : complex_(complex), guide_(guide) {}

    /// Give every landmark to the nearest facet, and note which facets are beyond the tolerance.
    void begin();

    // Replacing facets: clear, name those that go and those that come, ask, and only then carry out.
    void clear();
    void goes(const Facet &key);
    void comes(const Facet &key, int patch);
    bool allows_replacing();
    /// Add the facets that come, hand them the landmarks, and remove those that go. The energies of tets at facets that
    /// stay over are then to be measured anew: true if there are such facets.
    bool replace();

    /// How far beyond the tolerance facets that come may be for now, in tolerances: a neighbourhood that is being
    /// rearranged may leave it on the way. 0 at rest.
    double loose = 0.0;
    /// Cosine of the angle by which creases bend. Where the surface does not bend nearly as much, no edge within a
    /// patch comes to bend more, unless one beside it that goes or moves has bent as much.
    double crease = -1.0;
    /// Whether an angle between two creases at a corner that is not acute stays divided: a facet that fills it is never
    /// acute, and takes several points at once to be rid of.
    bool divides_corners = false;

    /// Moving vertex v: name it, ask about places for it, and settle at one. That is granted where it is the place that
    /// was allowed last; of others the answer may be another than before: near two sheets of the surface it may depend
    /// on what was found near the place asked about last.
    void gather(int v);
    bool allows(const Vec3 &x);
    bool settle(const Vec3 &x);
    /// What facets beyond the tolerance cost at the place asked about last: the sum of 1 + over, and its gradient with
    /// respect to the vertex.
    double cost(Vec3 *gradient) const;
    /// How often it looked whether a facet of a curved patch is near.
    long looks() const { return looks_; }
    /// Unit normal of the surface at the vertex where it stands: the mean of its facets', larger ones count more.
    Vec3 normal() const;

  private:
    struct Piece {
        Facet key;
        int patch;
        bool planar;
        std::array<Vec3, 3> corners;
        unsigned edges = 7; // those to be looked at along their length
        double was_over = 0.0;
        double over = 0.0;
        Vec3 pull; // gradient of over with respect to the moving vertex
        SurfaceHints hints{};
        int landmark = -1; // first of those that it covers
    };
    struct Beside {
        Facet key;
        int patch;
        std::array<Vec3, 3> corners;
        std::int32_t hint; // where its patch is nearest to its middle
    };
    /// An edge between two facets of one patch.
    struct Hinge {
        std::size_t piece;
        int corner; // of the piece, opposite the edge
        int other;  // piece at the other side, or -1: a facet that stays
        int other_corner;
        Vec3 apex;   // of the facet that stays
        Vec3 normal; // of the surface there
    };
    struct Handed {
        int landmark;
        Facet to;
    };
    /// How many of the pieces fill an angle between two creases at a corner that is not acute.
    std::ptrdiff_t undivided(const std::vector<Piece> &pieces) const;
    bool facets_allow(const Vec3 &x);
    bool creases_allow(const Vec3 &x) const;
    /// Those of the pieces, both of new and of gone ones with facets that stay; edges of creases only if `all`.
    void find_hinges(const std::vector<Piece> &pieces, bool all, std::vector<Hinge> &hinges);
    /// The smallest cosine of the angle by which pieces bend at hinges where they bend as creases do and the surface
    /// does not; 1 if there are none.
    double sharpest(const std::vector<Piece> &pieces, const std::vector<Hinge> &hinges) const;
    /// Whether no new piece bends more at its hinges than is allowed there, or than gone pieces or places did.
    bool bends_allow();
    /// Whether no new piece runs through another one or a facet beside it, near facets beyond the tolerance, unless a
    /// gone piece or place did.
    bool crossings_allow();
    /// Whether one of the pieces runs through another or one of the others.
    static bool run_through(const std::vector<Piece> &pieces, const std::vector<const Beside *> &others);
    Piece piece(const Facet &key, int patch) const;
    /// One that is in the complex.
    Piece present(const Facet &key, const TetComplex::SurfaceFacet &facet) const;
    void skip_known_edges();
    /// How far over the tolerance the piece is where it is now; whether it may be, up to `allowed`.
    bool near(Piece &piece, double allowed) const;
    bool landmarks_covered();
    bool landmarks_covered(std::size_t piece);
    bool landmarks_left(std::size_t piece);
    bool leave(int landmark, std::size_t piece);
    bool cover(int landmark, const Piece &owner);
    const std::vector<Beside> &beside(int v);
    Piece *nearest(int landmark, int patch);
    double over(double distance) const;
    void farther(Piece &piece, double distance, const Vec3 &at, const Vec3 &to_surface) const;

    TetComplex &complex_;
    const SurfaceGuide &guide_;
    mutable long looks_ = 0;
    int vertex_ = -1; // that moves, or -1 while facets are replaced
    /// An edge of its crease, where no facet holds that near its curve.
    struct Along {
        int end;
        double gap; // from the curve, where it is beyond the tolerance; else 0
    };
    std::vector<Along> along_;
    std::vector<Piece> old_;
    std::vector<Piece> new_;
    std::vector<Handed> handed_;
    std::vector<std::pair<int, std::vector<Beside>>> beside_; // per vertex asked about: the facets there that stay
    struct Allowed {
        Vec3 at;
        std::vector<Piece> pieces;
        std::vector<Handed> handed;
    };
    Allowed allowed_; // the place allowed last, and what is to be noted there
    std::size_t suspect_ = 0;
    std::vector<Hinge> hinges_; // those asked about last
    std::vector<TetComplex::SurfaceAt> facets_;
};

} // namespace wct::search
