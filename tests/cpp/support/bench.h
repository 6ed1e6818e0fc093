#pragma once

#include "search/stratified_mesh.h"
#include "search/workbench.h"
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

/// A body as a mesh to be searched, and what its surface must stay near.
struct Bodied {
    Bodied(Body made, double tolerance);

    Body body;
    search::TetComplex mesh;
    search::SurfaceGuide guide;
};

/// A body with all that works on its complex, its energies measured, ready for single operators. A crowd that is not to
/// be copied.
struct Bench : Bodied, search::Workbench {
    explicit Bench(Body made, double tolerance = 0.02);
    Bench(const Bench &) = delete;
    Bench &operator=(const Bench &) = delete;

    /// Energies of all tets measured afresh.
    void measure();
};

} // namespace wct::tests
