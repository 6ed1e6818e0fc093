#pragma once

#include "cells.h"
#include "conform.h"
#include "monitor.h"
#include "pinned_filling.h"
#include "reference.h"
#include "region_map.h"

#include <span>
#include <vector>

namespace wct {

/// As conform, but the facets of the surface stay as they are: see PinnedFacets. The vertices inside give way to them,
/// and are moved a little where that takes ties apart. Empty where the facets leave no choice.
Interior conform_inside(const Reference &reference, const InputMesh &mesh, const std::vector<char> &pinned,
                        std::span<const Edge> edges, std::span<const double> size, const ConformForm &form,
                        Monitor &monitor);

} // namespace wct
