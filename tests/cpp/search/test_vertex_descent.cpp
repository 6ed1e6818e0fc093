#include "search/vertex_descent.h"

#include "support/bench.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

namespace wct::tests {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

} // namespace

TEST_CASE("VertexDescent: a vertex that is held, or that went, is not moved") {
    Body body = ball(4, 0.2, 23);
    const auto held =
        static_cast<int>(std::find(body.stratum.begin(), body.stratum.end(), Stratum::patch) - body.stratum.begin());
    body.stratum[held] = Stratum::corner;
    body.label[held] = -1;
    Bench bench(body, 0.3);
    const Vec3 was = bench.complex.point(held);
    for (const double by : {1e-3, -1e-3}) {
        CHECK_FALSE(bench.descent.nudge(held, (1.0 + by) * was));
        CHECK_FALSE(bench.descent.relax(held, 4));
    }
    CHECK(bench.complex.point(held) == was);
    int went = 0;
    for (const auto &[key, patch] : bench.complex.sorted_surface()) {
        if (!bench.complex.used(key[0]) || !bench.complex.used(key[1]) ||
            !bench.operators.collapse(key[0], key[1], kInfinity))
            continue;
        const Vec3 gone = bench.complex.point(key[0]);
        CHECK_FALSE(bench.descent.nudge(key[0], 0.999 * gone));
        CHECK_FALSE(bench.descent.relax(key[0], 4));
        CHECK(bench.complex.point(key[0]) == gone);
        ++went;
    }
    CHECK(went > 3);
}

} // namespace wct::tests
