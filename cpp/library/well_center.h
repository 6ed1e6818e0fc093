#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

/// Makes tetrahedral meshes well-centered: every tet contains its circumcenter.
///
/// A mesh comes in as plain arrays. Its own boundary, and the interfaces between its regions, are the surface that the
/// new mesh stays near; the inside is sampled anew. Everything here is in the unit of length of the points that came
/// in, whatever that is, unless it is called a fraction.
namespace wct {

/// What every tet is to be.
enum class WellCenterGoal {
    well_centered,            ///< It contains its circumcenter (3WC): all dual edges and volumes are positive.
    completely_well_centered, ///< And so do all its triangles, which are acute then (CWC).
};

/// A tet mesh to begin with. Nothing is copied or changed; points that no tet has are left out of account.
struct WellCenterInput {
    /// Coordinates, one row a point.
    std::span<const std::array<double, 3>> points;
    /// Rows of `points`, from 0. Tets are positive: det(p1 - p0, p2 - p0, p3 - p0) > 0. They meet face to face.
    std::span<const std::array<int, 4>> tets;
    /// A number per tet, any: where it changes is an interface, which stays. Empty: one region, 0.
    std::span<const int> regions = {};
};

/// What a progress callback hears.
struct WellCenterProgress {
    /// "resampling", and of the search "passes", "kicks", "margin".
    std::string_view stage;
    /// The part of the stage that is done, 0 to 1.
    double done;
    /// Tets of the best mesh so far that miss the goal.
    std::size_t bad;
};

/// What is asked for. The defaults suit most meshes.
struct WellCenterOptions {
    WellCenterGoal goal = WellCenterGoal::completely_well_centered;
    /// How far the new surface may be from the old one, and the other way, as a fraction of the diagonal of the
    /// bounding box: above 0, at most 0.1. Where walls, gaps or radii are small it is a tenth of those, but no less
    /// than a quarter of this. None: 1e-3, or how deep the surface's own facets are on a smooth one, if that is more.
    std::optional<double> tolerance = {};
    /// Edges where the surface bends by more are creases and stay creases, in degrees: above 0, below 180.
    double crease_angle = 40.0;
    /// Edge length wanted, in the unit of the points; shorter where the tolerance needs it. None: the mesh's own.
    std::optional<double> edge_length = {};
    /// Clearance aimed at once all tets meet the goal: smallest h/R, and smallest cosine of the angles. 0 to 0.1.
    double margin = 0.02;
    /// Multiplies the work after which the search ends, which is some 6 s and 4 ms per tet of one core. 1 to 100.
    int effort = 1;
    /// Most tets that the new mesh may have. None: two million, or 20 times those that came in if that is more.
    std::optional<std::size_t> max_tets = {};
    /// Of the random choices. The same input, options and seed give the same bits on one build.
    std::uint64_t seed = 0;
    /// Threads to work on; 0: one per core. The result does not depend on it.
    unsigned threads = 0;
    /// Called now and then, on the caller's own thread; false ends the work. What it throws comes out of `well_center`.
    std::function<bool(const WellCenterProgress &)> progress = {};
};

/// The regions on the two sides of a patch.
struct WellCenterSides {
    int behind;                ///< Region behind its facets, against their normals.
    std::optional<int> before; ///< Region before them; none: the outside.
};

/// The boundary of a mesh and the interfaces between its regions, cut along creases.
///
/// Numbers of patches and curves are those of the mesh that came in, also on a new mesh: that is how boundary
/// conditions are carried over.
struct WellCenterSurface {
    std::vector<std::array<int, 3>> facets;  ///< Rows of points; outward, or out of the region with the lower number.
    std::vector<int> patch;                  ///< Per facet: a connected part of the surface without a crease inside.
    std::vector<WellCenterSides> sides;      ///< Per patch.
    std::vector<std::array<int, 2>> creases; ///< Rows of points, ascending in each.
    std::vector<int> curve;                  ///< Per crease edge: its chain of edges between corners, from 0.
    std::vector<int> corners; ///< Rows of points where creases meet, end or turn by more than 45 degrees, ascending.
};

/// The volume of a region.
struct WellCenterVolume {
    int region;
    double before; ///< Of the mesh that came in.
    double after;  ///< Of the one that goes out.
};

/// What was reached, and what it took.
struct WellCenterMetrics {
    std::size_t bad_before = 0;            ///< Tets that came in and miss the goal, decided exactly.
    std::size_t bad_after = 0;             ///< Tets that go out and miss it, decided exactly.
    std::size_t facets_off = 0;            ///< Facets that go out and are farther from the surface than the tolerance.
    bool reached = false;                  ///< Whether the goal is met by all tets and no facet is off.
    bool kept = false;                     ///< Whether the mesh that came in goes out, as nothing better was found.
    bool stopped = false;                  ///< Whether the progress callback ended the work.
    bool exhausted = false;                ///< Whether all the work that `effort` allows was done and tets are bad.
    int starts = 0;                        ///< Searches: the first, and others after it was stuck.
    int passes = 0;                        ///< Sweeps over all bad tets.
    std::int64_t kicks = 0;                ///< Tries of the iterated local search.
    std::int64_t evaluations = 0;          ///< Of a tet's energy: ten to twenty take a microsecond.
    double tolerance = 0.0;                ///< That was used, as a fraction of the diagonal.
    std::vector<int> released;             ///< Curves, creases by their angle alone, that became ordinary surface. The
                                           ///< patches beside them were joined under the smallest number.
    std::vector<WellCenterVolume> volumes; ///< By region, ascending.
};

/// A mesh that is no worse than the one that came in.
struct WellCenterResult {
    std::vector<std::array<double, 3>> points;
    std::vector<std::array<int, 4>> tets; ///< Rows of `points`; positive.
    std::vector<int> regions;             ///< Per tet, numbers of the mesh that came in.
    WellCenterSurface surface;
    WellCenterMetrics metrics;
};

/// Sample the domain of a mesh anew and search until every tet meets the goal.
///
/// The new mesh has the regions, interfaces, creases and corners of the old one, and the topology of each region. It is
/// given back only if a smaller share of its tets misses the goal; else what came in is, to the bit.
/// Throws std::invalid_argument, before any work, with one line that names what is wrong: an index out of range, a
/// coordinate that is not finite, a tet that is inverted or flat, a facet of more than two tets or with two on one
/// side, a bounding box whose diagonal is not between 1e-90 and 1e90, an option out of its range.
WellCenterResult well_center(const WellCenterInput &input, const WellCenterOptions &options = {});

/// The surface of a mesh as `well_center` sees it, to tell which patch a facet belongs to; throws as that does.
WellCenterSurface find_surface(const WellCenterInput &input, double crease_angle = 40.0);

} // namespace wct
