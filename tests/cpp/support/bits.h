#pragma once

#include <cstdint>

namespace wct::tests {

/// A hash of the meshes, to the bit, that three bodies become: a cube, two regions, a ball. Builds for other
/// instruction sets, and other counts of threads, give the same.
std::uint64_t bits_of_whole_runs();

} // namespace wct::tests
