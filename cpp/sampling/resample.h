#pragma once

#include "base/monitor.h"
#include "domain/reference.h"
#include "domain/region_map.h"
#include "domain/sizing.h"
#include "energy/energy.h"
#include "sampling/cloud.h"
#include "sampling/cloud_descent.h"
#include "sampling/deviation.h"
#include "sampling/held_surface.h"
#include "sampling/partial_renewal.h"
#include "sampling/restricted_delaunay.h"
#include "sampling/seeds.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace wct::sampling {

/// What is asked of resample, and the constants it works with.
struct ResampleOptions {
    domain::SizingForm sizing;
    bool cosines = true;
    std::uint64_t seed = 1;
    /// Hears about how many tets there will be, before any is made; false gives up. Not asked of a renewal.
    std::function<bool(double tets)> expected;

    static constexpr double offset = 1.05; // of vertices over a bend, relative to what regular facets would need
    static constexpr double shell = 0.95;  // no offset beyond this share of the tolerance
    static constexpr int sweeps = 25;      // of relaxation, at most
    static constexpr double step = 0.7;
    /// Share of its last move that a point keeps until the points are calm, moving by less than so many sizes; then
    /// sweeps without settle them, so many at most, until they are nearly still. Half as much momentum leaves a torus
    /// twice the bad tets, none three times; steps that stop where they would turn back do the same.
    static constexpr double momentum = 0.7;
    static constexpr double calm = 0.012;
    static constexpr int settling = 8;
    static constexpr double still = 0.005;
    static constexpr int mend_from = 4;     // sweep from which holes are filled and crowds thinned
    static constexpr int mend_every = 4;    // sweeps, but in the last of them
    static constexpr int refresh_every = 8; // sweeps after which points ask for their sizes anew
    static constexpr double longest = 1.38; // surface edge, in sizes
    static constexpr double shortest = 0.62;
    static constexpr int rounds = 20; // of descent
    /// What so many rounds must bring the bad tets down to for another to begin: the local search mends the rest
    /// sooner.
    static constexpr int lately = 2;
    static constexpr double worth = 0.9;
    /// And by how many at least, as a share of all tets, on smooth bodies: a round costs as much as the search of half
    /// as many bad ones. At creases each that is left costs more.
    static constexpr double least_worth = 2e-3;
    static constexpr int iterations = 15; // of L-BFGS per round
    static constexpr double reach = 0.1;  // longest step of a point, in sizes
    static constexpr int rings = 2;       // of tets round what is short of a margin that descend too, deep inside
    /// More where the domain was not met or parts are cut through, with smaller sizes there and where sheets touched.
    static constexpr int attempts = 2;
    static constexpr int trials = 1; // of the deviation, before the real run
    static constexpr int trial_sweeps = 8;
    static constexpr double target = 0.72; // of the tolerance, for the mean facet
    /// Share of the tolerance beyond which a facet counts as off, as in the local search.
    static constexpr double held = 0.86;
    /// Share of the facets that may be off before sizes shrink and everything starts once more. Scans have 3-4 %, which
    /// the local search mends as soon as it would a start with a sixth more tets; a ball of coarse facets at a fine
    /// tolerance has 6 % and takes five times as long without, noise of two tolerances 22 %.
    static constexpr double few_off = 0.05;
    static constexpr double fit_target = 0.7; // share that costs nothing: between samples facets are farther off
    /// Against the tets' energies; ten times that doubles the bad tets and gains little.
    static constexpr double fit_weight = 0.1;
    static constexpr double fit_pull = 0.02;
    static constexpr energy::EnergyForm energy{0.12, 2.5, 0.08, 2.5, 1.0, 0.003};
};

struct Resampled {
    Cloud cloud;
    RestrictedDelaunay complex;
    Flaws flaws;
    Tally tally;
    Deviation deviation;
    /// No flaws but at corners, no facet far across planes, no gap in their creases, the domain's Euler
    /// characteristics, all held facets.
    bool intact = false;
    std::vector<int> lost; // points where it is not, but for corners
    long work = 0;         // as of WorkUnits
    bool stopped = false;  // without a tet, where that was before there was any mesh; as where it was given up
    std::vector<std::pair<std::string, double>> stats;
};

/// Resample the domain, but for what is held, or only what the renewal makes anew: see make_seeds, relax and descend.
/// The reference's offsets are set on the way.
Resampled resample(domain::Reference &reference, const domain::InputMesh &mesh, std::span<const double> wanted,
                   const ResampleOptions &options, const std::optional<PartialRenewal> &renewal,
                   const HeldSurface *held, Monitor &monitor, const Workers &workers);

} // namespace wct::sampling
