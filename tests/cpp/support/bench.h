#pragma once

#include "search/group_descent.h"
#include "search/operators.h"
#include "search/stratified_mesh.h"
#include "search/vertex_descent.h"
#include "support/bodies.h"

namespace wct::tests {

/// The body as the mesh of a search; wanted sizes per point, none: the body's own everywhere.
search::StratifiedMesh stratified_mesh(const Body &body, std::vector<double> size = {});

/// The complex of a body, its energies not measured yet.
search::TetComplex complex_of(const Body &body);

/// The body as the surface that its own mesh stays near.
search::SurfaceGuide guide_of(const Body &body, double tolerance, double spacing);

/// The form that sees most: acute angles, needles, the count.
search::SearchForm search_form();

/// A body with all that works on its complex, ready for single operators. A crowd that is not to be copied.
struct Bench {
    explicit Bench(Body made, double tolerance = 0.02);
    Bench(const Bench &) = delete;
    Bench &operator=(const Bench &) = delete;

    /// Energies of all tets measured afresh.
    void measure();

    Body body;
    search::TetComplex complex;
    search::SurfaceGuide guide;
    search::SearchEnergy energy;
    search::SurfaceWatch watch;
    search::Operators operators;
    search::VertexDescent descent;
    search::GroupDescent group;
};

} // namespace wct::tests
