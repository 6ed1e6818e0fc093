#pragma once

#include "base/parallel.h"
#include "domain/reference.h"
#include "domain/region_map.h"
#include "domain/sharp_edges.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace wct::domain {

/// The edge length is to be no more than this round a place, and to grow from there.
struct SizeLimit {
    Vec3 at;
    double size;
};

struct SizingForm {
    double tolerance = 0.0;    // greatest distance between mesh and surface, in the mesh's unit
    std::vector<double> local; // the same per point of the surface, where it is less in places; empty: it is not
    double thickness = 0.8;    // size per local thickness
    double gap = 1.0;          // size per distance to the other side of a gap outside
    bool sharp = true;         // shorter edges along sharp edges
    bool one_row = true;       // of tets through layers at interfaces where edges are long; else three
    double coarsen = 1.0;      // how far inside sizes may exceed the input's own
    std::vector<double> most;  // longest edges wanted per point of the surface; empty: as inside
    std::vector<SizeLimit> limits;

    /// The least of a patch.
    double least_at(int patch, const Reference &reference) const;
    double tolerance_at(int vertex) const { return local.empty() ? tolerance : local[vertex]; }

    static constexpr double sag = 1.31; // sag of a typical facet, as a multiple of the tolerance
    /// The same where the tolerance is large by the domain's own thickness: vertices over a facet that deep can stand
    /// out far enough to keep the volume.
    static constexpr double keeping_sag = 0.95;
    /// What a sag of 1.31 loses of the volume, in tolerances times the area, and the share that may be lost.
    static constexpr double lost_depth = 0.1;
    static constexpr double lost_volume = 0.0025;
    /// Gap, and crease, that is told apart by sizes, in tolerances: in folds gaps go to nothing.
    static constexpr double narrowest = 8.0;
    static constexpr double surface_grade = 0.15; // growth of the size per distance, along the surface
    static constexpr double inner_grade = 0.3;    // and inside
    /// The same where there are interfaces or sheets, but from walls of layers of one row. An interface must suit the
    /// tets on both sides: where it bends, the next points on its hollow side are fewer already, and with edges that
    /// grow by .3 as well tets there are too tall for their facets.
    static constexpr double parted_grade = 0.25;
};

/// Ratio of the boundary's edge length to the cell of the BCC lattice that goes with it.
inline constexpr double kCellPerEdge = 1.0 / 1.05;

/// Target edge length everywhere.
///
/// Near the surface, and all through thin walls, it is what curvature, thickness, the lengths of creases and the input
/// allow, from there it grows with the depth, up to the input's own local size: the edge of the lattice that has as
/// many tets per volume as the input has there.
class Sizing {
  public:
    /// Gaps outside limit sizes, but for those whose sides meet at no less than this: 2 sin of half of 11 degrees.
    static constexpr double kNarrowestNotch = 0.2;

    /// `wanted`: edge length per input point; empty: the input's own.
    Sizing(const Reference &reference, const InputMesh &mesh, const RegionMap &map, const SizingForm &form,
           std::span<const double> wanted, const Workers &workers);

    double at(const Vec3 &p) const;
    /// The same, quicker where `triangle` is the one that limited the size at a place near by; -1: not known. It
    /// becomes the one that does so here.
    double at(const Vec3 &p, int &triangle) const;
    double input_size(const Vec3 &p) const;
    double smallest() const { return smallest_; }
    double largest() const { return largest_; }
    const SizingForm &form() const { return form_; }
    const SharpEdges &sharp() const { return sharp_; }
    /// The same of what is outside.
    const SharpEdges &notches() const { return notches_; }
    /// How far from a sharp edge the first vertices off it belong.
    double clearance(const SharpFoot &foot) const;
    /// The sharp edge within whose clearance p is, if it is in one.
    SharpFoot cleared_by(const Vec3 &p) const;

    /// Edge length per reference vertex. After changing it call grade().
    std::vector<double> surface;
    void grade();

    /// Whether there is a layer at an interface where edges are long enough for one row of tets.
    bool has_rows() const { return has_rows_; }
    /// How thick the layer is through which one row of tets goes at a vertex of the surface, 0 where there is none.
    double layer(int vertex) const { return layer_[vertex]; }
    /// The thicker one of those at the ends of a curve.
    double layer(const Curve &curve) const {
        return std::max(layer_[curve.vertices.front()], layer_[curve.vertices.back()]);
    }

  private:
    void make_input_sizes(std::span<const double> wanted);
    /// Of a typical facet, as a multiple of the tolerance, that keeps the domain's volume.
    double sag() const;
    /// Places along wires, which no triangle's size tells of.
    void limit_by_wires();
    void limit_by_places();
    void limit_by_curvature();
    /// Where a patch bends between two large triangles, curvature, which is smoothed, says too little: no facet may cut
    /// across the edge so far from its end that it is too deep there.
    void limit_by_bends();
    /// No crease is shorter than the edges it must have: where edges round its ends are longer, tets there are too few
    /// to open the angles between its neighbours.
    void limit_by_creases();
    /// Where a crease passes another, or a patch, the edges of both are opposite edges of tets, which are well-centered
    /// only where they are not much longer than the two are apart. Thickness does not tell of it where no sides face
    /// each other; it does of creases of one patch, and of its neighbours.
    void limit_by_passing_creases();
    /// Not near sharp edges, where thickness goes to nothing.
    void limit_by_thickness(const Workers &workers);
    /// By the mean of what triangles that were measured allow, larger ones count more.
    void limit_to_mean(const std::vector<double> &thin, const std::vector<char> &measured);
    /// Edges along a sharp edge are shorter than others by as much as the region is thinner.
    void limit_by_sharp_edges();
    void find_growth();
    static constexpr double kThick = 2.0; // sizes: a wall no thicker is thin
    /// The same of walls that have a curved interface, and as deep as this, in sizes, sizes do not grow on its hollow
    /// side, or in such a wall: the next points there are few as it is, and tets too tall for their facets else.
    static constexpr double kThickBent = 2.5;
    static constexpr double kHollow = 0.35;
    /// What thickness and gaps at a triangle allow, and how far off what is opposite inside is, infinite where nothing
    /// is.
    struct Thickness {
        double limit;
        std::array<double, 2> wall;  // behind the triangle and before it: from a plane, or between outer sides
        std::array<double, 2> apart; // the same of sides of any kind
        double layer;                // of a layer through which one row of tets goes
        bool row;                    // where an interface is a side of such a layer, or would be
    };
    /// A layer between two parallel patches through which one row of tets may go: how thick it is, infinite where there
    /// is none, and whether an interface or a sheet is one of the two.
    struct Row {
        double thickness;
        bool inner;
    };
    /// Whether a triangle has a corner on a layer of one row.
    bool at_layer(int triangle) const;
    /// Whether it is of an interface or a sheet that bends.
    bool bent_inside(int triangle) const;
    /// How deep sizes do not grow from a triangle, behind it and before it.
    std::array<double, 2> flat_depths(int triangle, double size) const;
    /// The layer on a side of a triangle. `wanted`: the size that all but curvature allows there.
    Row row_at(int triangle, int side, double wanted) const;
    /// What is farther than `reach` is not seen.
    Thickness thickness_at(int triangle, double wanted, double reach) const;
    /// The edge near p at which sides so far apart there meet, none if they do not. It is looked for as far as at
    /// `least` (2 sin of half the angle between the sides) it may be.
    static SharpFoot closing(const SharpEdges &edges, const Vec3 &p, double width, double least);
    /// Whether a gap outside is no wider only since its sides meet near p: facets there do not reach across.
    bool notched(const Vec3 &p, double gap) const;
    /// Whether what is inside is no thicker only since its sides meet near p.
    bool tapered(const Vec3 &p, double thickness) const;

    const Reference &reference_;
    const InputMesh &mesh_;
    const RegionMap &map_;
    SizingForm form_;
    SharpEdges sharp_;
    SharpEdges notches_;
    std::vector<double> input_; // per input point
    double volume_ = 0.0;       // of the input
    bool uniform_ = false;
    bool has_rows_ = false;
    std::vector<double> limit_;
    std::vector<double> patch_area_;
    std::vector<double> curved_; // what curvature allows per point of the surface, infinite where it is flat
    std::vector<double> layer_;  // thickness of a layer with one row of tets per point, 0 where there is none
    std::vector<std::array<double, 2>> wall_;  // per triangle: thickness of walls, as of Thickness
    std::vector<std::array<double, 2>> apart_; // the same of sides of any kind
    std::vector<std::array<double, 2>> flat_;  // per triangle: as deep as this sizes do not grow, behind and before it
    std::vector<double> growth_;               // per triangle: of sizes per distance from there on
    // Least per node of the reference's tree: of sizes, of those that would grow from the surface on to the same, and
    // of growths.
    std::vector<double> least_, least_from_, least_growth_;
    double smallest_ = 0.0;
    double largest_ = 0.0;
};

/// Sag of an equilateral facet of unit edge over a surface with these principal curvatures: how far it leaves the
/// surface to one side, or to both together where the surface is a saddle.
double unit_sag(double k1, double k2);

} // namespace wct::domain
