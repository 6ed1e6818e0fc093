#pragma once

#include "base/multiversion.h"

namespace wct {

// Not std::min and std::max: those take references, which keep loops over lanes from becoming vectors.
WCT_INLINE double larger(double a, double b) {
    return a > b ? a : b;
}
WCT_INLINE double smaller(double a, double b) {
    return a < b ? a : b;
}

} // namespace wct
