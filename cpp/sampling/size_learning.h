#pragma once

#include "domain/reference.h"
#include "domain/sizing.h"
#include "sampling/cloud.h"
#include "sampling/deviation.h"
#include "sampling/resample.h"

#include <vector>

namespace wct::sampling {

/// Where vertices sit over curved patches and creases: outside of the bend, so that chords run on both sides of it.
void set_offsets(domain::Reference &reference, const domain::Sizing &sizing, const ResampleOptions &options,
                 const std::vector<double> &correction);

/// Shift offsets and shrink sizes where the measured deviation asks for it. They grow again, up to where they were at
/// the start, where they were shrunk too much.
void learn(const Deviation &deviation, domain::Sizing &sizing, std::vector<double> &correction,
           const std::vector<double> &ceiling, const ResampleOptions &options);

/// Shrink sizes where facets are off the tolerance, or nearly: the local search mends few of them, and slowly.
void shrink(const Deviation &deviation, domain::Sizing &sizing, const ResampleOptions &options);

/// Shrink sizes at points where facets are too large: sheets touched each other, facets cut across, or creases have
/// gaps.
void refine(const Cloud &cloud, const std::vector<int> &touched, const domain::Reference &reference,
            domain::Sizing &sizing);

} // namespace wct::sampling
