#include "domain/sizing.h"

#include "base/random.h"
#include "support/bodies.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace wct::tests {

namespace {

struct Sized {
    Body body;
    domain::InputMesh mesh;
    domain::Reference reference;
    domain::RegionMap map;
    domain::Sizing sizing;

    Sized(Body made, const domain::SizingForm &form, std::vector<double> wanted = {})
        : body(std::move(made)), mesh(body.mesh()), reference(body.surface()), map(mesh, reference),
          sizing(reference, mesh, map, form, wanted, Workers(2)) {}
    Sized(const Sized &) = delete;
};

} // namespace

TEST_CASE("Sizing: grows no faster than its grades, and stays between its least and its largest") {
    domain::SizingForm form;
    form.tolerance = 0.01;
    const Sized one(ball(5, 0.1, 1), form);
    Random random(1);
    for (int k = 0; k < 300; ++k) {
        const Vec3 p = 0.6 * random.normal3(), q = p + 0.2 * random.normal3();
        if (norm(p) > 0.95 || norm(q) > 0.95)
            continue;
        const double a = one.sizing.at(p), b = one.sizing.at(q);
        CHECK(std::abs(a - b) <= domain::SizingForm::inner_grade * norm(p - q) * (1.0 + 1e-9) + 1e-12);
        CHECK(a >= one.sizing.smallest() * (1.0 - 1e-12));
        CHECK(a <= one.sizing.largest() * (1.0 + 1e-12));
    }
}

TEST_CASE("Sizing: a place that asks for short edges gets them, and its surroundings follow") {
    domain::SizingForm form;
    form.tolerance = 0.01;
    const Vec3 at{0.5, 0.5, 0.0};
    const Sized plain(cube(4, 0.0, 1), form);
    form.limits = {{at, 0.05}};
    const Sized finer(cube(4, 0.0, 1), form);
    CHECK(plain.sizing.at(at) > 0.15);
    CHECK(finer.sizing.at(at) <= 0.05 * 1.3);
    CHECK(finer.sizing.at({0.5, 0.5, 0.5}) <= 0.05 + 0.3 * 0.5 + 0.05);
    CHECK(finer.sizing.at({0.0, 0.0, 1.0}) <= plain.sizing.at({0.0, 0.0, 1.0}));
}

TEST_CASE("Sizing: wanted lengths are followed, finer tolerances make shorter edges on what bends") {
    domain::SizingForm form;
    form.tolerance = 0.01;
    Body body = cube(4, 0.0, 1);
    const std::size_t count = body.points.size();
    const Sized fine(body, form, std::vector<double>(count, 0.1)), coarse(body, form, std::vector<double>(count, 0.2));
    CHECK(fine.sizing.at({0.5, 0.5, 0.5}) / coarse.sizing.at({0.5, 0.5, 0.5}) == doctest::Approx(0.5).epsilon(0.05));
    domain::SizingForm strict = form;
    strict.tolerance = 0.0025;
    const Sized loose(ball(6, 0.0, 1), form), tight(ball(6, 0.0, 1), strict);
    // A facet's sag goes with the square of its edges.
    CHECK(tight.sizing.smallest() / loose.sizing.smallest() == doctest::Approx(0.5).epsilon(0.2));
}

TEST_CASE("unit_sag: of a sphere, a cylinder and a plane") {
    // An equilateral facet of edge 1 on a sphere of radius r: its center is 1 / (6 r) under it.
    CHECK(domain::unit_sag(0.1, 0.1) == doctest::Approx(0.1 / 6.0).epsilon(0.02));
    CHECK(domain::unit_sag(0.0, 0.0) == 0.0);
    CHECK(domain::unit_sag(0.1, 0.0) == doctest::Approx(0.1 / 8.0).epsilon(0.1)); // a chord's
    CHECK(domain::unit_sag(0.2, 0.2) == doctest::Approx(2.0 * domain::unit_sag(0.1, 0.1)));
}

} // namespace wct::tests
