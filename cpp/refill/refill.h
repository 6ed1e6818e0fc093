#pragma once

#include "base/cells.h"
#include "base/monitor.h"
#include "domain/reference.h"
#include "domain/region_map.h"
#include "domain/sizing.h"
#include "energy/energy.h"
#include "refill/pinned_filling.h"
#include "sampling/seeds.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace wct::refill {

/// What is asked of refill, and the constants it works with.
struct RefillOptions {
    double size = 0.8; // of the new tets, relative to the input's own or the wanted size
    double most = 2.0; // tets per tet of the input; larger ones are made where that would be passed
    /// Facets that stay have spheres of their own that points keep off.
    sampling::SeedForm seeds{.edge_per_cell = 1.2, .interface_depth = sampling::SeedForm::least_depth};
    bool cosines = true;
    std::uint64_t seed = 1;
    /// Hears about how many tets there will be, before any is made; false: none is.
    std::function<bool(double tets)> expected;

    static constexpr int sweeps = 25; // of relaxation
    static constexpr double step = 0.7;
    static constexpr int rounds = 6;      // of descent
    static constexpr int iterations = 15; // of L-BFGS per round
    static constexpr double reach = 0.1;  // longest step of a point, in sizes
    static constexpr energy::EnergyForm energy{0.12, 2.5, 0.08, 2.5, 1.0, 0.003};
};

/// Fill a mesh anew between the surface facets, which stay as they are: see PinnedFacets. Inside, a relaxed lattice
/// takes the place of the input's vertices. `reference` is the mesh's own surface, with the mesh's own points. Empty
/// where nothing could be filled anew.
Refilled refill(const domain::Reference &reference, const domain::InputMesh &mesh, const std::vector<char> &pinned,
                std::span<const Edge> edges, std::span<const double> wanted, const RefillOptions &options,
                Monitor &monitor, const Workers &workers);

} // namespace wct::refill
