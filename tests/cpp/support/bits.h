#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace wct::tests {

/// A run from start to end, and a hash of what it gave: the mesh to the bit, kicks and evaluations.
struct WholeRun {
    std::string name;
    std::uint64_t bits;
};

/// Small runs of every kind. Builds for other instruction sets, and other counts of threads, give the same bits.
std::vector<WholeRun> whole_runs();

/// A hash of values of the C library's functions: where it is another, whole runs may have other bits.
std::uint64_t bits_of_library();

} // namespace wct::tests
