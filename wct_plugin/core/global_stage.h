#pragma once

#include "cloud.h"
#include "descent.h"
#include "deviation.h"
#include "energy.h"
#include "monitor.h"
#include "reference.h"
#include "region_map.h"
#include "restricted.h"
#include "seeds.h"
#include "sizing.h"

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace wct {

struct GlobalForm {
    SizingForm sizing;
    SeedForm seeds;
    double offset = 1.05; // of vertices over a bend, relative to what regular facets would need
    double shell = 0.95;  // no offset beyond this share of the tolerance
    int sweeps = 25;      // of relaxation
    double step = 0.7;
    int mend_from = 4;     // sweep after which holes are filled and crowds thinned
    double longest = 1.38; // surface edge, in sizes
    double shortest = 0.62;
    int rounds = 20;     // of descent
    int iterations = 15; // of L-BFGS per round
    double reach = 0.1;  // longest step of a point, in sizes
    int attempts = 1;    // more where the domain was not met, with smaller sizes where its sheets touched each other
    int trials = 1;      // of the deviation, before the real run
    int trial_sweeps = 8;
    double target = 0.72;    // of the tolerance, for the mean facet
    double held = 0.86;      // share of the tolerance beyond which a facet counts as off, as in the local search
    double fit_target = 0.7; // share that costs nothing: between samples facets are farther off
    double fit_weight = 0.1; // against the tets' energies; ten times that doubles the bad tets and gains little
    double fit_pull = 0.02;
    bool cosines = true;
    EdgeForm edge;
    std::uint64_t seed = 1;
    EnergyForm energy{0.12, 2.5, 0.08, 2.5, 1.0, 0.003};
};

struct GlobalResult {
    Cloud cloud;
    Complex complex;
    Flaws flaws;
    Tally tally;
    Deviation deviation;
    bool intact = false; // no flaws but at corners, and the domain's Euler characteristics
    bool stopped = false;
    std::vector<std::pair<std::string, double>> stats;
};

/// Resample the domain: see make_seeds, relax and descend. The reference's offsets are set on the way.
GlobalResult resample(Reference &reference, const InputMesh &mesh, std::span<const double> wanted,
                      const GlobalForm &form, Monitor &monitor);

} // namespace wct
