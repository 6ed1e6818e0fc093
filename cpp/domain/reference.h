#pragma once

#include "base/cells.h"
#include "base/vec3.h"
#include "geometry/box_tree.h"
#include "geometry/plane.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace wct::domain {

/// The surface a mesh should stay near, cut into strata. Indices count points; triangles of a patch agree in side.
struct SurfaceData {
    std::vector<Vec3> points;
    std::vector<Facet> triangles;
    std::vector<int> patch;     // per triangle, from 0
    std::vector<Edge> segments; // crease edges
    std::vector<int> curve;     // per segment, from 0
    std::vector<int> corners;
    std::vector<Edge> folds; // edges that bend as creases do and are none
    std::vector<std::array<int, 2>>
        sides;         // per patch: the region behind its triangles, the region before; -1 is outside
    double flat = 0.0; // as far off a plane or line vertices may be where they count as on it
};

/// A point of the surface.
struct Foot {
    Vec3 point;
    int triangle = -1;
    double weight[3] = {0.0, 0.0, 0.0};
    double distance = std::numeric_limits<double>::infinity();
};

/// A point of a crease: on the segment between two successive vertices of its chain.
struct CurveFoot {
    Vec3 point;
    Vec3 tangent;
    int step = -1;
    double along = 0.0;
    double distance = std::numeric_limits<double>::infinity();
};

/// A chain of crease edges between corners, or a loop (the first vertex is then not repeated).
struct Curve {
    std::vector<int> vertices;
    bool closed = false;
    bool straight = false;
    std::vector<Vec3> bend;  // curvature vector per vertex: towards the center, 1 / radius long
    std::vector<Vec3> shift; // where the mesh's crease runs, relative to the vertex
    geometry::BoxTree tree;  // over the steps

    int steps() const { return static_cast<int>(vertices.size()) - (closed ? 0 : 1); }
    int least_edges() const { return closed ? 3 : 1; } // of a mesh that has the curve
    int at(int k) const { return vertices[k % static_cast<int>(vertices.size())]; }
};

/// Patches, curves and corners with what is needed to measure them and to stay on them.
///
/// A *wedge* is a vertex as one patch sees it, between creases and folds: it has the normal and the curvatures there.
class Reference {
  public:
    explicit Reference(SurfaceData data);

    const SurfaceData &data() const { return data_; }
    double diagonal() const { return diagonal_; }
    /// Least distance of what a ray hits from the triangle it starts on.
    double ray_start() const { return 1e-6 * diagonal_; }
    int patches() const { return static_cast<int>(planar_.size()); }
    bool planar(int patch) const { return planar_[patch]; }
    /// The region behind a patch's triangles and the one before, -1 is outside.
    const std::array<int, 2> &sides(int patch) const { return data_.sides[patch]; }
    /// Whether regions, or one region, are on both sides of the patch.
    bool inner(int patch) const { return data_.sides[patch][0] >= 0 && data_.sides[patch][1] >= 0; }
    bool has_inner() const;
    /// Whether the patch lies inside a region.
    bool sheet(int patch) const { return inner(patch) && data_.sides[patch][0] == data_.sides[patch][1]; }
    /// Whether any of these patches is an interface or a sheet inside.
    bool any_inner(const std::vector<int> &patches) const {
        return std::any_of(patches.begin(), patches.end(), [&](int patch) { return inner(patch); });
    }
    double length(int curve) const; // of its own polygon
    /// Whether no curved patch is beside the curve, as round a flat contact or sheet, and along a wire: its own corners
    /// are all there is to tell its course.
    bool bare(int curve) const {
        return std::all_of(curve_patches_[curve].begin(), curve_patches_[curve].end(),
                           [&](int patch) { return planar(patch); });
    }
    /// Whether it is planar and so large that the local search keeps it exactly.
    bool keeps(int patch, double tolerance) const;
    const std::vector<Curve> &curves() const { return curves_; }

    /// Nearest point of the surface, or of one patch. Sooner where `hint` is a triangle nearby; the answer does not
    /// depend on it.
    Foot nearest(const Vec3 &p, int patch = -1, int hint = -1) const;
    /// Over all triangles.
    const geometry::BoxTree &tree() const { return tree_; }
    CurveFoot nearest_on_curve(const Vec3 &p, int curve, bool shifted = false) const;
    /// First hit of a ray between `least` and `most`: distance and triangle (-1: none).
    double ray(const Vec3 &p, const Vec3 &direction, double least, double most, int &triangle) const;

    /// The unit vector along a triangle, square to a direction, away from the edge of it that runs that way.
    Vec3 away(int triangle, const Edge &edge, const Vec3 &along) const;
    /// Unit normal of the triangle, and the smooth one: corner normals interpolated (planar patches: the plane's own).
    const Vec3 &normal(int triangle) const { return normals_[triangle]; }
    Vec3 smooth_normal(const Foot &foot) const;
    /// The patches that meet at a curve or a vertex, ascending.
    const std::vector<int> &patches_at_curve(int curve) const { return curve_patches_[curve]; }
    const std::vector<int> &patches_at_vertex(int vertex) const { return vertex_patches_[vertex]; }
    /// Whether a patch has both curves.
    bool share_patch(int curve, int other) const {
        const auto &around = curve_patches_[other];
        return std::any_of(curve_patches_[curve].begin(), curve_patches_[curve].end(),
                           [&](int patch) { return std::binary_search(around.begin(), around.end(), patch); });
    }
    /// Which side of the surface is p on, given its foot: the region there.
    int region_beside(const Vec3 &p, const Foot &foot) const;
    /// Signed distance, positive before the triangles; only meaningful near the foot.
    double height(const Vec3 &p, const Foot &foot) const;

    double area(int triangle) const { return areas_[triangle]; }
    int wedge(int triangle, int corner) const { return wedges_[triangle][corner]; }
    int wedges() const { return static_cast<int>(wedge_vertex_.size()); }
    int wedge_vertex(int wedge) const { return wedge_vertex_[wedge]; }
    /// Principal curvatures per wedge, |first| >= |second|, positive where the surface bends away from its normal.
    const std::array<double, 2> &curvature(int wedge) const { return curvatures_[wedge]; }

    /// Distance from the surface at which the mesh's patch points sit, per wedge; and the same for curves.
    std::vector<double> offset;
    std::vector<Curve> &curves() { return curves_; }
    void rebuild_curves();

    /// Put a point on its patch (at the offset) or curve. Returns the normal or the tangent there. `foot`: the nearest
    /// point of the patch.
    Vec3 to_patch(Vec3 &p, const Foot &foot) const;
    Vec3 to_curve(Vec3 &p, int curve) const;

  private:
    void try_triangle(const Vec3 &p, int triangle, double &square, Foot &foot) const;
    void make_wedges();
    void make_normals();
    void find_planes();
    void make_curvatures();
    /// Replace each wedge's curvatures by the mean with its neighbours'.
    void smooth_curvatures();
    /// visit(from, to) for the wedges at the ends of each edge of each triangle of curved patches, both ways.
    template <class Visit> void along_edges(const Visit &visit) const;
    void make_curves();
    void bend_curve(Curve &curve);
    void find_patches_around();

    SurfaceData data_;
    double diagonal_ = 0.0;
    double scale_ = 0.0; // largest coordinate
    std::vector<Vec3> normals_;
    std::vector<double> areas_;
    std::vector<std::array<int, 3>> wedges_;
    std::vector<int> wedge_vertex_;
    std::vector<Vec3> wedge_normal_;
    std::vector<std::array<double, 2>> curvatures_;
    std::vector<Vec3> vertex_normal_;
    std::vector<std::array<Vec3, 3>> edge_normal_; // opposite corner k; sum of both triangles' normals
    std::vector<char> planar_;
    std::vector<geometry::Plane> plane_;
    geometry::BoxTree tree_;
    struct PatchTree {
        std::vector<int> triangles;
        geometry::BoxTree tree;
    };
    std::vector<PatchTree> patch_trees_;
    std::vector<Curve> curves_;
    std::vector<std::vector<int>> curve_patches_;
    std::vector<std::vector<int>> vertex_patches_;
};

/// Some unit vector across a unit vector.
Vec3 across(const Vec3 &n);

} // namespace wct::domain
