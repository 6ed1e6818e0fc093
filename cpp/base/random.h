#pragma once

#include "base/vec3.h"

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace wct {

/// A well-mixed function of a number (the finalizer of SplitMix64): as good as chance, and the same every time.
inline std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers on every platform, unlike the standard distributions.
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    /// Uniform in [0, 1).
    double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

    std::uint64_t next() { return mix(state_ += kStep); }

    /// What a state grows by from one number to the next.
    static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15ull;

    /// 0 .. count - 1; the bias below 2^-32 does not matter here.
    int below(int count) { return static_cast<int>((next() >> 32) * static_cast<std::uint64_t>(count) >> 32); }

    bool coin() { return next() >> 63; }

    /// Normal distribution (Box and Muller 1958).
    double normal() {
        const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
        return radius * std::cos(6.283185307179586 * uniform());
    }

    Vec3 normal3() {
        const double x = normal(), y = normal(), z = normal();
        return {x, y, z};
    }

    template <class T> void shuffle(std::vector<T> &items) {
        for (int k = static_cast<int>(items.size()) - 1; k > 0; --k)
            std::swap(items[k], items[below(k + 1)]);
    }

  private:
    std::uint64_t state_;
};

} // namespace wct
