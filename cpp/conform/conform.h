#pragma once

#include "base/cells.h"
#include "base/monitor.h"
#include "base/parallel.h"
#include "conform/conforming_cloud.h"
#include "domain/reference.h"
#include "domain/region_map.h"
#include "sampling/restricted_delaunay.h"
#include "sampling/surface_labels.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace wct::conform {

/// What is asked of conform, and the constants it works with.
struct ConformOptions {
    bool one_sided = true; // else Delaunay is enough
    double tolerance = 0.0;
    std::uint64_t seed = 1;
    int effort = 1; // multiplies the rounds
    /// Per patch whether its vertices stay where they are; others may be moved a little within their plane.
    std::vector<std::uint8_t> stays;

    static constexpr int rounds = 80;
    static constexpr int patience = 20;   // rounds without progress
    static constexpr int astray = 3;      // with faults, after which slivers are mended from the best state again,
    static constexpr double fewest = 0.1; // and about this share of them, at least
    /// Tets with which a round without progress is the last, by how many came: near ties can multiply them in each.
    static constexpr std::size_t most(std::size_t tets) { return 10'000 + 50 * tets; }
    static constexpr double held = 0.6;     // distance of facets from the reference, in tolerances
    static constexpr double least = 1e-6;   // dual length, in circumradii
    static constexpr double tied = 1e-10;   // the same below zero, where it may be none
    static constexpr double sharpest = 0.5; // dihedral angle of a tet, in those of the mesh that comes in
};

/// What keeps a complex from its goal, by the number of places.
struct Faults {
    std::size_t creases = 0; // segments that are no edges
    std::size_t surface = 0; // points inside that lie open, and points where the surface is no disk
    std::size_t off = 0;     // facets off their patch or farther off than the tolerance
    std::size_t outer = 0;   // boundary facets whose tet has its circumcenter beyond them
    std::size_t edges = 0;   // edges of the boundary whose dual area is not positive
    std::size_t ties = 0;    // facets inside with a dual edge of no length
    std::size_t slivers = 0; // tets much sharper than any that came in, if nothing else is wrong: no fault
    std::size_t unsound() const { return creases + surface + off; }
    std::size_t all() const { return unsound() + outer + edges + ties; }
};

struct Conformed {
    std::vector<Vec3> points;
    std::vector<int> origin; // per point: the input's, -1 for new ones
    std::vector<Stratum> role;
    std::vector<int> label;
    std::vector<double> size; // wanted edge length
    std::vector<Tet> tets;
    std::vector<int> region;
    sampling::SurfaceLabels surface;
    Faults faults;
    int rounds = 0;
    bool intact = false; // the domain is represented: creases, surfaces and the topology of every region
    bool stopped = false;
};

/// Make a mesh Delaunay, and one-sided, by the Delaunay triangulation of its own vertices: of the vertices inside those
/// go that crowd the surface, and new ones come on the surface where its own are too far apart, as in the refinement of
/// Ruppert and Shewchuk. Vertices of the surface stay, its facets flip or are split. `reference` is the mesh's own
/// surface, with the mesh's own points; facets stay within the tolerance of it or of `given`, the surface it stands
/// for.
Conformed conform(const domain::Reference &reference, const std::optional<domain::Reference> &given,
                  const domain::InputMesh &mesh, std::span<const Stratum> stratum, std::span<const int> label,
                  std::span<const double> size, const ConformOptions &options, Monitor &monitor,
                  const Workers &workers);

} // namespace wct::conform
