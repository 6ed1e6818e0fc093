#pragma once

#include "cloud.h"
#include "reference.h"

#include <vector>

namespace wct {

/// A point of the cloud on a curve.
struct CurveStop {
    double at; // along the curve, in steps of its chain
    int point;
};

/// Per curve its points in order, corners at its ends included; a closed curve ends with its first point again.
std::vector<std::vector<CurveStop>> curve_chains(const Cloud &cloud, const Reference &reference);

} // namespace wct
