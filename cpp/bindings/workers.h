#pragma once

#include "base/parallel.h"

#include <algorithm>
#include <cstdlib>
#include <thread>

namespace wct::bindings {

/// So many threads; 0: as many as OMP_NUM_THREADS says, which is what users of numerical libraries set, else one per
/// core.
inline Workers workers_of(unsigned threads) {
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    if (threads == 0) {
        threads = cores;
        if (const char *text = std::getenv("OMP_NUM_THREADS"))
            if (const long wanted = std::strtol(text, nullptr, 10); wanted > 0)
                threads = static_cast<unsigned>(std::min(wanted, 4L * cores));
    }
    return Workers(threads);
}

} // namespace wct::bindings
