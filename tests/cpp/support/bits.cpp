#include "support/bits.h"

#include "support/remesh.h"

#include <bit>
#include <cmath>

namespace wct::tests {

namespace {

/// FNV-1a over words, byte by byte.
class Hash {
  public:
    void add(std::uint64_t word) {
        for (int k = 0; k < 8; ++k) {
            value = (value ^ (word & 0xff)) * 0x100000001b3;
            word >>= 8;
        }
    }
    void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
    std::uint64_t value = 0xcbf29ce484222325;
};

std::uint64_t bits_of(const Searched &made) {
    Hash hash;
    const search::TetComplex &complex = made.complex;
    for (std::size_t k = 0; k < complex.vertex_slots(); ++k) {
        const search::Vertex &v = complex.vertex(static_cast<int>(k));
        for (const double x : {v.position.x, v.position.y, v.position.z})
            hash.add(x);
        hash.add(static_cast<std::uint64_t>(v.stratum));
    }
    for (std::size_t k = 0; k < complex.tet_slots(); ++k)
        if (const int t = static_cast<int>(k); complex.alive(t))
            for (const int v : complex.tet(t))
                hash.add(static_cast<std::uint64_t>(v));
    for (const auto &[key, patch] : complex.sorted_surface())
        hash.add(static_cast<std::uint64_t>(patch));
    hash.add(static_cast<std::uint64_t>(made.outcome.bad));
    hash.add(static_cast<std::uint64_t>(made.outcome.kicks));
    hash.add(static_cast<std::uint64_t>(made.outcome.evaluations));
    return hash.value;
}

search::SearchOptions few_kicks() {
    search::SearchOptions options;
    options.kicks = 60;
    return options;
}

} // namespace

std::vector<WholeRun> whole_runs() {
    std::vector<WholeRun> runs;
    unsigned threads = 1;
    const auto add = [&](const char *name, const Searched &made) { runs.push_back({name, bits_of(made)}); };
    const auto made_anew = [&](const char *name, const Body &body, double tolerance) {
        add(name, searched(resampled(body, tolerance, threads++), body, tolerance, few_kicks()));
    };
    made_anew("a cube made anew", cube(4, 0.2, 1), 0.02);
    made_anew("two regions made anew", cube(4, 0.2, 2, 0.5), 0.02);
    made_anew("a ball made anew", ball(5, 0.1, 3), 0.02);
    made_anew("a cylinder made anew", cylinder(5, 0.1, 4), 0.03);

    add("a shaken cube", searched(start_of(cube(3, 0.3, 4)), cube(3, 0.3, 4), 0.02, few_kicks()));
    add("two shaken regions", searched(start_of(cube(4, 0.25, 5, 0.5)), cube(4, 0.25, 5, 0.5), 0.02, few_kicks()));
    add("a shaken cylinder", searched(start_of(cylinder(4, 0.15, 6)), cylinder(4, 0.15, 6), 0.04, few_kicks()));
    add("creases given up", searched(start_of(cut_ball(4, 0.2, 3)), cut_ball(4, 0.2, 3), 0.02, few_kicks(), true));

    search::SearchOptions options = few_kicks();
    options.acute = false;
    options.margin = 0.05;
    options.crease = std::cos(0.5);
    options.volumes = {4.0};
    add("a ball, any triangles", searched(start_of(ball(4, 0.2, 7)), ball(4, 0.2, 7), 0.03, options));

    options = few_kicks();
    options.flip_surface = options.split_surface = false;
    options.most = 180;
    add("a pinned surface", searched(pinned(cube(3, 0.25, 8)), cube(3, 0.25, 8), 0.02, options));

    options = few_kicks();
    options.fixed = {1, 0, 0, 0, 0, 0};
    options.fixed_curves = {1, 1, 1};
    options.fixed_curves.resize(12, 0);
    options.work = 400'000;
    options.worth = 2000.0;
    add("one face fixed", searched(start_of(cube(3, 0.25, 9)), cube(3, 0.25, 9), 0.02, options));

    const Body round = ball(4, 0.15, 10);
    std::vector<double> local(round.points.size(), 0.04);
    for (std::size_t v = 0; v < local.size(); ++v)
        if (round.points[v].x > 0.0)
            local[v] = 0.015;
    add("a tighter tolerance on one side", searched(start_of(round), round, 0.04, few_kicks(), false, local));
    return runs;
}

std::uint64_t bits_of_library() {
    Hash hash;
    for (int k = 1; k < 400; ++k) {
        const double x = k / 401.0;
        for (const double y :
             {std::acos(x), std::atan2(x, 0.3), std::cbrt(x), std::cos(x), std::exp2(x), std::hypot(x, 0.7),
              std::log(x), std::log2(x), std::pow(x, 1.5), std::sin(x), std::tan(x)})
            hash.add(y);
    }
    return hash.value;
}

} // namespace wct::tests
