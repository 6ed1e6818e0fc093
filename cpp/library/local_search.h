#pragma once

#include "base/parallel.h"
#include "domain/sizing.h"
#include "library/limits.h"
#include "library/listener.h"
#include "library/own_surface.h"
#include "search/stratified_mesh.h"

#include <optional>
#include <vector>

namespace wct::library {

/// What a search has led to.
struct Found {
    search::StratifiedMesh mesh;
    std::size_t bad = 0;    // tets that miss the goal, or are at facets beyond the tolerance
    std::size_t off = 0;    // facets beyond the tolerance
    std::vector<int> stuck; // the bad tets, by row
    int passes = 0;
    long kicks = 0;
    long evaluations = 0;
    std::vector<int> released; // curves, ascending
};

/// How far the new mesh may be from the surface.
struct Tolerance {
    double most = 0.0;         // a length
    std::vector<double> local; // per point of the surface, where it is less in places; empty: it is not
};
Tolerance find_tolerance(const OwnSurface &surface, double most, const Workers &workers);

/// The local search, from a start that is given or resampled, and from others where it is stuck.
class LocalSearch {
  public:
    LocalSearch(const Mesh &mesh, const OwnSurface &surface, Tolerance tolerance, const WellCenterOptions &options,
                Listener &listener);

    /// The mesh itself as a start: corners stay where they are.
    search::StratifiedMesh own_start() const;
    /// The relaxed lattice start; none where it does not represent the domain, has too many tets, or was stopped.
    std::optional<search::StratifiedMesh> resampled(const std::vector<domain::SizeLimit> &finer, int attempt);
    /// Search from there, without the creases that were released before, for at most this part of the work that is
    /// left. `worth`: evaluations per tet after which kicks may be given up.
    Found run(const search::StratifiedMesh &start, const std::vector<int> &released, double worth, double part = 1.0);
    /// What the search makes of a resampled start, and of others that are finer where the best of them is stuck.
    std::vector<Found> run_finer(search::StratifiedMesh start);

    bool exhausted() const { return work_.left() == 0; }

  private:
    double worth() const;
    /// Edges round what is stuck are to be shorter.
    void add_limits(const Found &found, std::size_t tried, std::vector<domain::SizeLimit> &finer) const;

    const Mesh &mesh_;
    const OwnSurface &surface_;
    Tolerance tolerance_;
    const WellCenterOptions &options_;
    Listener &listener_;
    Workers workers_;
    TetLimit limit_;
    WorkLimit work_;
    std::vector<double> wanted_;  // edge length per point of the mesh; empty: its own
    std::vector<double> longest_; // edges per point of the surface; empty where others are wanted
    std::vector<int> sheets_;     // of the surface that meet at each of its points
};

/// Rows of those with the fewest bad tets first; of equals the last, from which others were tried.
std::vector<std::size_t> ranked(const std::vector<Found> &tried);

/// That many threads; 0: one per core.
Workers workers_of(unsigned threads);

} // namespace wct::library
