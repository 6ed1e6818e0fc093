#include "search/crease_release.h"

#include "support/bench.h"
#include "support/remesh.h"
#include "support/state.h"

#include <doctest/doctest.h>

#include <cmath>
#include <set>

namespace wct::tests {

namespace {

constexpr double kTolerance = 0.02;

/// A ball cut into an upper and a lower patch: the crease between them runs along edges, not smoothly.
Body cut_ball(int n, double jitter, std::uint64_t seed) {
    Body made = ball(n, jitter, seed);
    Body body = stratified(made.points, made.tets, made.regions,
                           [](const Vec3 &middle, const Vec3 &) { return middle.z > 0.03 ? 0 : 1; });
    body.size = made.size;
    return body;
}

search::LoosenedSurface loosened(const Body &body, bool loose) {
    int curves = 0;
    for (const int c : body.curve)
        curves = std::max(curves, c + 1);
    return {body.points,  body.facets, body.patch,
            body.creases, body.curve,  std::vector<std::uint8_t>(static_cast<std::size_t>(curves), loose),
            0.0,          {}};
}

search::SearchOptions little() {
    search::SearchOptions options;
    options.kicks = 40;
    return options;
}

const search::SearchProgress kQuiet = [](const char *, double, int) { return true; };

} // namespace

TEST_CASE("CreaseRelease: a crease that holds tets up becomes ordinary surface, and they come right") {
    const Body body = cut_ball(4, 0.2, 3);
    REQUIRE(body.sides.size() == 2);
    REQUIRE_FALSE(body.creases.empty());
    search::TetComplex held = complex_of(body);
    search::CreaseRelease stiff(held, loosened(body, false), kTolerance, 0.125 * body.size);
    const int left = stiff.run(little(), kQuiet).bad;
    CHECK(stiff.released().empty());
    REQUIRE(left > 0);

    search::TetComplex complex = complex_of(body);
    search::CreaseRelease release(complex, loosened(body, true), kTolerance, 0.125 * body.size);
    const search::SearchOutcome outcome = release.run(little(), kQuiet);
    REQUIRE_FALSE(release.released().empty());
    CHECK(outcome.bad < left);
    CHECK(not_well_centered(complex, true) <= outcome.bad);
    CHECK(fault(complex) == "");
    CHECK(characteristics(complex) == std::vector<int>{1});
    const std::set<int> gone(release.released().begin(), release.released().end());
    for (const auto &[edge, curve] : complex.creases())
        CHECK_FALSE(gone.contains(curve));
    for (const auto &[key, patch] : complex.sorted_surface())
        CHECK(patch == 0); // the smallest number of those joined
    for (std::size_t k = 0; k < complex.vertex_slots(); ++k) {
        const search::Vertex &v = complex.vertex(static_cast<int>(k));
        if (complex.used(static_cast<int>(k)) && v.stratum == Stratum::crease)
            CHECK_FALSE(gone.contains(v.label));
    }
    // What was held before is within the tolerance still: the true surface is that of the facets as they were.
    const search::SurfaceGuide guide = guide_of(ball(4, 0.2, 3), kTolerance, 0.125 * body.size);
    for (const auto &[key, patch] : complex.sorted_surface()) {
        search::SurfaceHints hints{};
        CHECK(guide.gap(0, complex.corners(key), hints).distance <= kTolerance * (1.0 + 1e-9));
    }
}

TEST_CASE("CreaseRelease: straight creases of planes stay, whatever is said of them") {
    const Body body = cube(3, 0.3, 8);
    search::TetComplex complex = complex_of(body);
    search::CreaseRelease release(complex, loosened(body, true), kTolerance, 0.125 * body.size);
    search::SearchOptions options = little();
    options.passes = 1;
    options.kicks = 2; // so that some stay bad
    release.run(options, kQuiet);
    CHECK(release.released().empty());
    CHECK(fault(complex) == "");
    std::set<int> patches;
    for (const auto &[key, patch] : complex.sorted_surface())
        patches.insert(patch);
    CHECK(patches.size() == 6);
}

} // namespace wct::tests
