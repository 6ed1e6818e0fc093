#pragma once

#include "base/work.h"
#include "search/group_descent.h"
#include "search/kick.h"
#include "search/mesh_change.h"
#include "search/operators.h"
#include "search/repair.h"
#include "search/search_options.h"
#include "search/vertex_descent.h"

#include <optional>

namespace wct::search {

/// What has been spent on looking for changes.
struct Spent {
    long evaluations = 0;
    long looks = 0; // of a SurfaceWatch

    long work() const { return evaluations + WorkUnits::look * looks; } // as of WorkUnits
    Spent &operator+=(const Spent &other) {
        evaluations += other.evaluations;
        looks += other.looks;
        return *this;
    }
    Spent operator-(const Spent &other) const { return {evaluations - other.evaluations, looks - other.looks}; }
};

/// What an attempt has come to: the change, if there is one that may stay, and what it takes.
struct Attempt {
    std::optional<MeshChange> change;
    double gain = 0.0; // of energy
    Spent spent;
};

/// A mesh and all that one thread needs to work on it.
struct Workbench {
    /// `divides_corners` as of SurfaceWatch.
    Workbench(TetComplex &mesh, const SurfaceGuide &guide, const SearchForm &form, const SearchOptions &options,
              bool divides_corners);

    Spent spent() const { return {energy.evaluations(), watch.looks()}; }

    /// Try something, which says whether it may stay, with random numbers of its own. The mesh is then as it was.
    template <class Body> Attempt attempt(std::uint64_t seed, const Body &body) {
        const Spent before = spent();
        Attempt made;
        random = Random(seed);
        complex.mark();
        if (body()) {
            made.change = complex.change();
            made.gain = complex.gain();
        }
        complex.rollback();
        made.spent = spent() - before;
        return made;
    }

    TetComplex &complex;
    SearchEnergy energy;
    SurfaceWatch watch;
    Operators operators;
    VertexDescent descent;
    GroupDescent group;
    Random random;
    Repair repair;
    Kick kick;
};

} // namespace wct::search
