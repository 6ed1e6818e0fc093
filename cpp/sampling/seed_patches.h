#pragma once

#include "base/random.h"
#include "domain/reference.h"
#include "domain/sizing.h"
#include "sampling/cloud.h"
#include "sampling/partial_renewal.h"
#include "sampling/seeds.h"

#include <optional>

namespace wct::sampling {

/// Points on the patches, an edge length from each other and from those on their rims: a pattern that grows over the
/// patches, and where it leaves room, points by darts (blue noise). Where it is stopped, some are missing.
void seed_patches(Cloud &cloud, const domain::Reference &reference, const domain::Sizing &sizing, const SeedForm &form,
                  const std::optional<PartialRenewal> &renewal, Random &random, Monitor &monitor);

} // namespace wct::sampling
