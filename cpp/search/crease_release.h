#pragma once

#include "search/local_search.h"

namespace wct::search {

/// The surface of a SurfaceGuide, and which of its creases may be given up.
struct LoosenedSurface {
    std::vector<Vec3> points;
    std::vector<Facet> triangles;
    std::vector<int> patch; // of each triangle, from 0
    std::vector<Edge> segments;
    std::vector<int> curve;          // of each segment, from 0
    std::vector<std::uint8_t> loose; // by curve: a crease by its angle alone, which may be released
    double flat = 0.0;               // as of SurfaceGuide::Surface
    std::vector<double> local;       // the same
};

/// The search, and the release of creases that hold it up.
///
/// A scan has creases and corners a few tolerances apart, where its facets happen to bend by more than the crease
/// angle: the links of such corners leave no well-centered choice at any edge length. When kicks get no further, the
/// creases near the tets that are left become ordinary surface: patches on either side are joined, vertices on them
/// move freely in their shell. All that was held before is within the tolerance still, and so is all that comes, both
/// ways. Planes and lines that are kept exactly, and creases between them, are never released.
class CreaseRelease {
  public:
    /// `tolerance` and `spacing` as of SurfaceGuide.
    CreaseRelease(TetComplex &complex, LoosenedSurface surface, double tolerance, double spacing)
        : complex_(complex), surface_(std::move(surface)), tolerance_(tolerance), spacing_(spacing) {}

    /// Search until no tet is bad, or none of the bad ones is near a crease that may be released.
    SearchOutcome run(const SearchOptions &options, const SearchProgress &progress);
    /// The curves that were released, ascending. Patches joined have the smallest number of any of them; no other patch
    /// or curve has got another number.
    const std::vector<int> &released() const { return released_; }

  private:
    /// By curve.
    std::vector<std::uint8_t> releasable(const SurfaceGuide &guide) const;
    /// Curves that may go, with crease edges near these tets.
    std::vector<int> near(const std::vector<int> &bad, const std::vector<std::uint8_t> &may) const;
    void release(const std::vector<int> &curves);
    /// By patch: the one it becomes without the curves that are gone.
    std::vector<int> join_patches(const std::vector<std::uint8_t> &gone) const;
    /// The complex without those curves.
    void relabel(const std::vector<std::uint8_t> &gone, const std::vector<int> &patch_of);

    TetComplex &complex_;
    LoosenedSurface surface_;
    double tolerance_, spacing_;
    std::vector<int> released_;
};

} // namespace wct::search
