#include "search/search_energy.h"

#include "support/bench.h"

#include <doctest/doctest.h>

namespace wct::tests {

TEST_CASE("SearchEnergy: a tet whose clearance is just what is asked for counts as short of it") {
    // The corner of a cube: right angles are exactly 0 here.
    Bench bench(cube(1, 0.0, 1));
    const Tet tet = bench.complex.tet(0);
    search::SearchForm form = search_form();
    form.clearance = form.hard_clearance = 0.0;
    form.count = form.hard_count = 0.0;
    const double smooth = search::SearchEnergy(form).of_present(bench.complex, tet);
    form.count = 0.25;
    form.hard_count = 0.5;
    CHECK(search::SearchEnergy(form).of_present(bench.complex, tet) == doctest::Approx(smooth + 0.75).epsilon(1e-14));
    form.clearance = -0.5; // beyond that it is clear of it, though not of the other
    CHECK(search::SearchEnergy(form).of_present(bench.complex, tet) == doctest::Approx(smooth + 0.5).epsilon(1e-14));
}

} // namespace wct::tests
