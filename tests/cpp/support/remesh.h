#pragma once

#include "search/local_search.h"
#include "support/bodies.h"

#include <array>

namespace wct::tests {

/// A start for the body, made by sampling: in strata, with the sizes of its points.
struct Start {
    Body body;
    std::vector<double> size;
    bool intact = false;
    std::size_t bad = 0;
};
Start resampled(const Body &body, double tolerance, unsigned threads, std::uint64_t seed = 1);

/// What the search makes of a start, on the surface of the body; `loose`: whether creases may be given up; `local`: the
/// tolerance at each of the body's points, where it is less.
struct Searched {
    search::TetComplex complex;
    search::SearchOutcome outcome;
    std::vector<int> released; // creases
};
Searched searched(const Start &start, const Body &on, double tolerance, const search::SearchOptions &options,
                  bool loose = false, const std::vector<double> &local = {});

/// The body itself as a start.
Start start_of(const Body &body);
/// The same with all vertices of the surface where they are.
Start pinned(const Body &body);

/// Whether a tet holds its circumcenter and, if `acute`, its facets theirs, exactly.
bool well_centered(const std::array<Vec3, 4> &corners, bool acute);

/// Tets of a complex that do not hold their circumcenter or, if `acute`, have a facet that does not, exactly.
int not_well_centered(const search::TetComplex &complex, bool acute);

} // namespace wct::tests
