#pragma once

#include "base/monitor.h"
#include "base/random.h"
#include "domain/reference.h"
#include "domain/region_map.h"
#include "domain/sizing.h"
#include "sampling/cloud.h"
#include "sampling/held_surface.h"
#include "sampling/partial_renewal.h"

#include <optional>

namespace wct::sampling {

struct SeedForm {
    double edge_per_cell = 1.1; // boundary edge per lattice cell
    /// Of lattice points off interfaces and sheets, in cells: the spheres of their facets are as deep on both sides,
    /// and empty only so.
    double interface_depth = 0.82;

    static constexpr double patch_spacing = 0.78; // least distance of patch points, in edge lengths
    static constexpr double front_spacing = 0.8;  // the same where a patch is filled by a growing pattern
    static constexpr double level_ratio = 1.3;    // of the lattice's cells from one level to the next
    static constexpr double least_depth = 0.52;   // of lattice points off what is outside, in cells
    static constexpr double level_gap = 0.72;     // between points of different levels, in mean cells
    static constexpr double wire_gap = 0.75;      // from points of wires, in edge lengths
    static constexpr int outliers = 50;           // one in so many sizes may be below the scale of the lattice
    static constexpr double jitter = 2e-3;        // of lattice points, in edge lengths: exact lattices are degenerate
};

/// Corners and points that divide their angles, evenly spaced points on curves, blue noise on patches, and inside a
/// body-centered cubic lattice whose cell follows the size field in steps, and the middles of thin walls. With a
/// renewal, those on patches and inside only in its zones; what is held has its own points. Where it is stopped, some
/// of those inside are missing.
Cloud make_seeds(const domain::Reference &reference, const domain::RegionMap &map, const domain::Sizing &sizing,
                 const SeedForm &form, const std::optional<PartialRenewal> &renewal, const HeldSurface *held,
                 Random &random, Monitor &monitor, const Workers &workers);

/// The lattice alone, of the scale that the sizes of the cloud's points ask for; new points keep off the surface.
void seed_inside(Cloud &cloud, const domain::Reference &reference, const domain::RegionMap &map,
                 const domain::Sizing &sizing, const SeedForm &form, const std::optional<PartialRenewal> &renewal,
                 Random &random, Monitor &monitor, const Workers &workers);

} // namespace wct::sampling
