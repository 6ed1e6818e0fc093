#include "support/bits.h"

#include "support/remesh.h"

#include <bit>

namespace wct::tests {

namespace {

/// FNV-1a, a word at a time.
void mix_in(std::uint64_t &hash, std::uint64_t word) {
    constexpr std::uint64_t prime = 0x100000001b3;
    for (int k = 0; k < 8; ++k) {
        hash = (hash ^ (word & 0xff)) * prime;
        word >>= 8;
    }
}

void mix_in(std::uint64_t &hash, const search::TetComplex &complex) {
    for (std::size_t k = 0; k < complex.vertex_slots(); ++k) {
        const Vec3 &p = complex.point(static_cast<int>(k));
        for (const double x : {p.x, p.y, p.z})
            mix_in(hash, std::bit_cast<std::uint64_t>(x));
    }
    for (std::size_t k = 0; k < complex.tet_slots(); ++k)
        if (const int t = static_cast<int>(k); complex.alive(t))
            for (const int v : complex.tet(t))
                mix_in(hash, static_cast<std::uint64_t>(v));
}

} // namespace

std::uint64_t bits_of_whole_runs() {
    constexpr double tolerance = 0.02;
    std::uint64_t hash = 0xcbf29ce484222325;
    unsigned threads = 1;
    for (const Body &body : {cube(4, 0.2, 1), cube(4, 0.2, 2, 0.5), ball(5, 0.1, 3)}) {
        search::SearchOptions options;
        options.kicks = 400;
        const Start start = resampled(body, tolerance, threads++);
        mix_in(hash, searched(start, body, tolerance, options).complex);
    }
    return hash;
}

} // namespace wct::tests
