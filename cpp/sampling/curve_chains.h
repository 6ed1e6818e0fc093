#pragma once

#include "domain/reference.h"
#include "sampling/cloud.h"

#include <vector>

namespace wct::sampling {

/// A point of the cloud on a curve.
struct CurveStop {
    double at; // along the curve, in steps of its chain
    int point;
};

/// Per curve its points in order, corners at its ends included; a closed curve ends with its first point again.
std::vector<std::vector<CurveStop>> curve_chains(const Cloud &cloud, const domain::Reference &reference);

} // namespace wct::sampling
