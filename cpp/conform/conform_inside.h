#pragma once

#include "base/cells.h"
#include "base/monitor.h"
#include "conform/conform.h"
#include "domain/reference.h"
#include "domain/region_map.h"
#include "refill/pinned_filling.h"

#include <span>
#include <vector>

namespace wct::conform {

/// As conform, but the facets of the surface stay as they are: see PinnedFacets. The vertices inside give way to them,
/// and are moved a little where that takes ties apart. Empty where the facets leave no choice.
refill::Refilled conform_inside(const domain::Reference &reference, const domain::InputMesh &mesh,
                                const std::vector<char> &pinned, std::span<const Edge> edges,
                                std::span<const double> size, const ConformOptions &options, Monitor &monitor);

} // namespace wct::conform
