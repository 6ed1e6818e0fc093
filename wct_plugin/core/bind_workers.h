#pragma once

#include "parallel.h"

#include <cstdlib>
#include <thread>

namespace wct {

/// So many threads; 0: as many as OMP_NUM_THREADS says, which is what users of numerical libraries set, else one per
/// core.
inline Workers workers_of(unsigned threads) {
    if (threads == 0)
        if (const char *wanted = std::getenv("OMP_NUM_THREADS"))
            threads = static_cast<unsigned>(std::strtoul(wanted, nullptr, 10));
    return Workers(threads ? threads : std::thread::hardware_concurrency());
}

} // namespace wct
