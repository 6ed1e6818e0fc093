#pragma once

#include "search/search_energy.h"
#include "search/surface_watch.h"
#include "search/tet_complex.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace wct::search {

/// The tets round edge ab in order: (a, b, link[k], link[k+1]) is positive. `closed`: the last meets the first.
struct Ring {
    std::vector<int> link;
    std::vector<int> tets;
    std::vector<Edge> opposite; // of each tet: link[k], link[k+1]
    bool closed = true;
};

/// Changes of connectivity. Each is refused (false, nothing changed) if it would leave a flat or inverted tet, a
/// surface facet off its patch by more than the tolerance, a crease off its curve, a pinched surface, or raise the
/// energy by `slack` or more. Surface facets keep their patch, crease edges their curve, tets their region, on hull and
/// interfaces alike. Changes are journaled; vertices whose star changed are added to `touched`.
class Operators {
  public:
    Operators(TetComplex &complex, const SearchEnergy &energy, const SurfaceGuide &guide, SurfaceWatch &watch)
        : complex_(complex), energy_(energy), guide_(guide), watch_(watch) {}

    /// Swap edge ab for the best triangulation of its link (Klincsek's dynamic program): 3-2, 4-4, 5-6, ...; on the
    /// surface the edge of two facets is flipped with it (2-2 there). A tet alone at an edge of the hull is cut off.
    bool remove_edge(int a, int b, double slack);
    /// Swap the facet of t opposite corner i for the edge between the two apices.
    bool flip_23(int t, int i, double slack);
    /// Move a onto b: a vanishes. A surface vertex only along the surface, a crease vertex along its crease.
    bool collapse(int a, int b, double slack);
    /// Halve ab by a new vertex; returns it. On failure after the vertex exists the caller's rollback removes it.
    std::optional<int> split(int a, int b, double slack);
    /// A new vertex at x in the cavity of tets round t0 whose circumspheres contain x; never across a surface facet.
    std::optional<int> insert(int t0, const Vec3 &x, double slack);
    /// A new vertex of the patch near x in the cavity of the surface facets round `at`, and of tets behind them, whose
    /// circumspheres contain it: its facets are those of a Delaunay triangulation, as a split edge's are not.
    std::optional<int> insert_on_surface(const Facet &at, const Vec3 &near, double slack);

    /// Where the surface and a facet beyond the tolerance are farthest apart: the landmark farthest from the facet, or
    /// else the point of the surface where the facet is farthest from it. A vertex there covers it best.
    std::optional<Vec3> farthest(const Facet &key) const;
    /// A new vertex of the surface there: in the cavity round the facet or else, where the surface goes on beyond an
    /// edge of the facet, as at the bottom of a slot or the rim of a fin, on that edge.
    std::optional<int> refine(const Facet &key, const Vec3 &peak, double slack);

    bool ring(int a, int b, Ring &ring) const;
    /// The same where several fans of tets meet in the edge, as where two bodies touch in it: tets and link in any
    /// order.
    bool fans(int a, int b, Ring &ring) const;
    std::vector<int> touched;
    void touch(int v);

    /// Whether surface edges may be flipped, and split.
    bool flip_surface = true;
    bool split_surface = true;
    /// Per patch whether its facets stay whatever other facets do; those beyond the end do not.
    std::vector<std::uint8_t> fixed;
    /// The same per curve of its edges.
    std::vector<std::uint8_t> fixed_curves;
    /// New edges stay within these multiples of the wanted size.
    double shortest = 0.35;
    double longest = 2.2;
    /// No change may leave more tets than so many.
    std::size_t most = std::numeric_limits<std::size_t>::max();
    /// Whether so many fresh tets may take the place of those that go.
    bool has_room(std::size_t gone, std::size_t fresh) const {
        return fresh <= gone || fresh - gone <= most - std::min(most, complex_.tets());
    }

  private:
    bool fixes(int patch) const { return static_cast<std::size_t>(patch) < fixed.size() && fixed[patch] != 0; }
    bool fixes_curve(int curve) const {
        return static_cast<std::size_t>(curve) < fixed_curves.size() && fixed_curves[curve] != 0;
    }
    struct Fan {
        std::vector<int> polygon;
        std::vector<int> tets;
        std::vector<char> wanted; // whether a plan may have the edge i-j of the polygon
        std::vector<double> pair; // energy of the two tets over triangle (i, k, j) of the polygon
        std::vector<double> cost; // of the cheapest triangulation of the polygon's corners i to j, closed by edge i-j
        std::vector<int> choice;  // the corner k of its triangle at that edge

        int corners() const { return static_cast<int>(polygon.size()); }
        int triangle(int i, int k, int j) const { return (i * corners() + k) * corners() + j; }
    };
    /// Find the cheapest way to fill a fan without its edge a-b; true if it costs less than `limit`.
    bool plan(Fan &fan, int a, int b, double limit);
    /// Candidates over the triangles on the edge i-j of the polygon, where both of their tets would be positive.
    void add_triangles(const Fan &fan, int a, int b, int i, int j);
    /// Measure the candidates, two to a triangle; true if any triangle costs less than `limit`. The others are none.
    bool measure_triangles(Fan &fan, double limit);
    /// Klincsek's dynamic program; returns the cost of the whole polygon.
    static double choose_triangles(Fan &fan);
    /// The surface facets at an edge: how many, their patch, and where in the link the last one stands.
    struct EdgeFacets {
        int count = 0;
        int patch = -1;
        int last = -1;
    };
    /// Whether the edge may go for what is of the surface at it: nothing, and tets all round, or two facets of one
    /// patch that may be flipped.
    bool find_edge_facets(int a, int b, EdgeFacets &facets) const;
    /// Cut the ring in fans; returns how many. At an interface two: both of its sides are between the same two facets.
    std::size_t cut_fans(const EdgeFacets &facets);
    /// Plan the fans; true if they have room and cost less than `limit` together.
    bool plan_all(std::span<Fan> fans, int a, int b, double limit);
    template <class Visit> static void each_triangle(const Fan &fan, const Visit &visit);
    /// The tets of the plan become the candidates.
    void take_planned(const Fan &fan, int a, int b);
    void carry_out(const Fan &fan, int a, int b);
    /// Whether facet abr or abs is farther from the surface than the tolerance.
    bool beyond(int a, int b, int r, int s) const;
    /// Whether the surface may go over ars and brs instead of abr and abs.
    bool allows_swap(int a, int b, int r, int s, int patch);
    bool flips_surface(int a, int b, int r, int s, int patch);
    /// Where the ring of ab is one tet, with two facets on the outside, one of them beyond the tolerance: cut it off;
    /// its other facets become the surface.
    bool cut_ear(int a, int b, double slack);
    /// Whether a and b are joined. A new edge between two that are would be there twice: a mesh that overlaps itself,
    /// as folds narrower than the tolerance may, leaves room for it.
    bool joined(int a, int b) const;
    /// Whether the planned fan has an edge that is there already.
    bool repeats(const Fan &fan) const;
    /// Sum of the tets' energies.
    double sum_of(const std::vector<int> &tets) const;
    /// Put the candidates, with their regions and energies, in the place of tets.
    void replace_tets(const std::vector<int> &gone);
    void touch_candidates();
    /// Measures the candidates; whether they can be and cost less than `limit` together.
    bool candidates_below(double limit);
    /// Whether every facet is of two tets at most once the candidates are there for the tets that go: see joined.
    bool candidates_fit(const std::vector<int> &gone) const;
    bool collapse_links(int a, int b, const Ring &ring) const;
    /// Whether the surface vertex a may go to b for what they are: along their crease or patch, and not to more
    /// freedom.
    bool collapses_along_surface(int a, int b);
    /// Candidates from the star of a with b in its place; false if there are none, or one is too large.
    bool pull_tets(int a, int b);
    /// Tell the watch of the facets at a that go, and come with b in its place; false if one turns too much or is there
    /// already.
    bool pull_facets(int a, int b);
    /// What the two crease edges at a become when it goes to b; empty if the creases do not allow it.
    std::optional<Edge> join_creases(int a, int b) const;
    /// A surface facet at an edge that is split: its corner opposite the edge.
    struct SplitFacet {
        int apex, patch;
    };
    /// Find the surface facets at the edge in the ring; whether it may be split for them and its curve.
    bool splits(int a, int b, std::vector<SplitFacet> &facets) const;
    /// A vertex for the middle of the edge, or for where the surface is farthest from the facets at it.
    Vertex middle_vertex(int a, int b, const std::vector<SplitFacet> &facets) const;
    /// The halves of the ring's tets become the candidates; returns the energy of the whole ones.
    double halve_tets(int a, int b, int v);
    /// A vertex of the facet's patch near x.
    Vertex surface_vertex(const Facet &at, const Vec3 &near) const;
    /// Take in the facets round those that are open that make room for x, across edges that are no creases; returns all
    /// edges of theirs, in order, those between two of them twice.
    std::vector<Edge> grow_opening(const Vec3 &x, int patch, std::vector<Facet> &open);
    /// The edges of one open facet only; false if a crease or a vertex would be left without a facet.
    bool find_rim(const std::vector<Edge> &edges, const std::vector<Facet> &open, std::vector<Edge> &rim) const;
    /// The tets at the open facets become the cavity.
    void start_cavity(const std::vector<Facet> &open);
    bool in_circumsphere(int t, const Vec3 &x) const;
    bool in_cavity(int t) const { return std::find(cavity_.begin(), cavity_.end(), t) != cavity_.end(); }
    /// Take in the tets round those of the cavity whose circumspheres contain x, though none across a surface facet,
    /// and give up those again that leave a facet on the wall which x does not see. False if there are too many, or if
    /// such a facet is of a tet that was there at first; x need not see the `open` facets of the surface.
    bool grow_cavity(const Vec3 &x, const std::vector<Facet> &open);
    bool carve_cavity(const Vec3 &x, const std::vector<Facet> &open, std::size_t kept);
    /// Candidates from v to every facet of the cavity's wall but the `open` ones of the surface.
    bool cone_cavity(int v, const std::vector<Facet> &open, double slack);
    /// Whether each facet between v and an edge of the cavity's walls has a tet on either side, or on one if the edge
    /// is on the rim of the surface facets that went: a cavity may touch itself along an edge, or reach the surface
    /// there.
    bool cone_is_closed(int v, const std::vector<Edge> &rim) const;
    void fill_cavity();

    TetComplex &complex_;
    const SearchEnergy &energy_;
    const SurfaceGuide &guide_;
    SurfaceWatch &watch_;
    Fan fans_[2];
    Ring ring_;
    std::vector<Tet> candidates_;
    std::vector<double> energies_;
    std::vector<int> regions_;
    std::vector<int> pairs_;
    std::vector<int> cavity_;
    std::vector<TetComplex::SurfaceAt> facets_;
};

} // namespace wct::search
