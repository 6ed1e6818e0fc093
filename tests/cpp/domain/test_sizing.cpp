#include "domain/sizing.h"

#include "base/random.h"
#include "support/bodies.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
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

/// Two cubes whose edges pass each other at right angles, so far apart, and no sides face each other: one of the unit
/// cube's edges along z, half-way up, and one of the other's half-way along.
Body passing_cubes(double apart) {
    Body one = cube(4, 0.0, 1);
    const Body other = cube(4, 0.0, 1);
    const double h = std::sqrt(0.5);
    const Vec3 out{h, h, 0.0}, up{0.0, 0.0, 1.0}, along{h, -h, 0.0};
    const Vec3 v = h * (out - up), w = h * (out + up); // along, v, w: right-handed
    const Vec3 from = Vec3{1.0, 1.0, 0.5} + apart * out - 0.5 * along;
    const int count = static_cast<int>(one.points.size());
    for (const Vec3 &p : other.points)
        one.points.push_back(from + p.x * along + p.y * v + p.z * w);
    for (const auto &[a, b, c, d] : other.tets)
        one.tets.push_back({a + count, b + count, c + count, d + count});
    one.regions.resize(one.tets.size(), 1);
    const std::vector<Vec3> axes{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, up, along, v, w};
    return stratified(one.points, one.tets, one.regions, [axes](const Vec3 &, const Vec3 &normal) {
        for (int k = 0; k < 12; ++k)
            if (dot(normal, (k % 2 ? -1.0 : 1.0) * axes[k / 2]) > 0.99)
                return k;
        return -1;
    });
}

/// A plate of this thickness, bent round the z axis by half a turn, whose middle has radius 1 and which is 1 high.
Body bent_plate(double thickness) {
    const Body flat = cube(12, 0.0, 1);
    std::vector<Vec3> points;
    for (const Vec3 &p : flat.points) {
        const double radius = 1.0 + thickness * (p.y - 0.5), turn = std::numbers::pi * p.x;
        points.push_back({-radius * std::cos(turn), radius * std::sin(turn), p.z});
    }
    return stratified(points, flat.tets, flat.regions, [](const Vec3 &middle, const Vec3 &normal) {
        if (std::fabs(normal.z) > 0.9)
            return normal.z > 0.0 ? 0 : 1;
        const double out = normal.x * middle.x + normal.y * middle.y;
        return std::fabs(out) > 0.5 ? (out > 0.0 ? 2 : 3) : middle.x > 0.0 ? 4 : 5;
    });
}

/// A ball of radius .5 in a ball, the wall between them so thick: two regions.
Body ball_in_ball(double wall, bool inner_first) {
    Body body = ball(8, 0.0, 1);
    for (Vec3 &p : body.points)
        if (const double far = norm(p); far > 0.5)
            p = (0.5 + 2.0 * (far - 0.5) * wall) / far * p;
    for (std::size_t t = 0; t < body.tets.size(); ++t) {
        const bool inside = std::ranges::all_of(body.tets[t], [&](int v) { return norm(body.points[v]) < 0.5 + 1e-9; });
        body.regions[t] = inside == inner_first ? 0 : 1;
    }
    return stratified(body.points, body.tets, body.regions, [](const Vec3 &, const Vec3 &) { return 0; });
}

/// The middle of a facet of the ball inside, and its normal out of that.
std::array<Vec3, 2> facet_inside(const Body &body) {
    for (const auto &[a, b, c] : body.facets) {
        const std::array<Vec3, 3> at{body.points[a], body.points[b], body.points[c]};
        const Vec3 middle = (1.0 / 3.0) * (at[0] + at[1] + at[2]), normal = unit(normal_of(at));
        if (norm(middle) < 0.5)
            return {middle, dot(normal, middle) > 0.0 ? normal : -1.0 * normal};
    }
    return {};
}

} // namespace

TEST_CASE("Sizing: edges are short where creases pass each other, and there alone") {
    domain::SizingForm form;
    form.tolerance = 1e-3;
    const Vec3 place{1.0, 1.0, 0.5}, far{0.0, 0.0, 0.5};
    const Sized alone(cube(4, 0.0, 1), form);
    const double usual = alone.sizing.at(place);
    CHECK(usual > 0.2);
    for (const double apart : {0.02, 0.05, 0.1}) {
        const Sized both(passing_cubes(apart), form);
        CHECK(both.sizing.at(place) == doctest::Approx(1.5 * apart).epsilon(1e-6));
        CHECK(both.sizing.at(place + apart * Vec3{std::sqrt(0.5), std::sqrt(0.5), 0.0}) ==
              doctest::Approx(1.5 * apart).epsilon(1e-6));
        CHECK(both.sizing.at(far) > 0.9 * usual);
    }
    CHECK(Sized(passing_cubes(1.0), form).sizing.at(place) == doctest::Approx(usual).epsilon(0.05));
    form.tolerance = 0.02; // what is less than some tolerances apart is not told apart
    CHECK(Sized(passing_cubes(0.02), form).sizing.at(place) == doctest::Approx(8.0 * 0.02).epsilon(1e-6));
}

TEST_CASE("Sizing: through a bent plate goes one row of tets, but where curvature asks for edges as short as two") {
    constexpr double thickness = 0.06, row = 1.4, two_rows = 0.8;
    const Vec3 inner{0.0, 1.0 - 0.5 * thickness, 0.5}, outer{0.0, 1.0 + 0.5 * thickness, 0.5};
    domain::SizingForm form;
    form.tolerance = 6e-3;
    const std::vector<double> wanted(13 * 13 * 13, 0.4);
    const Sized one(bent_plate(thickness), form, wanted);
    for (const Vec3 &p : {inner, outer})
        CHECK(one.sizing.at(p) == doctest::Approx(row * thickness).epsilon(0.02));
    form.tolerance = 3e-4; // facets may be as long as .06
    const Sized finer(bent_plate(thickness), form, wanted);
    for (const Vec3 &p : {inner, outer})
        CHECK(finer.sizing.at(p) == doctest::Approx(two_rows * thickness).epsilon(0.02));
}

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

TEST_CASE("Sizing: grows slower in a domain with an interface, from there and from its other walls") {
    constexpr double small = 0.05, large = 0.6;
    const auto with_small_at = [&](double x, double split) {
        Body body = cube(8, 0.0, 1, split);
        domain::SizingForm form;
        form.tolerance = 0.01;
        for (const Vec3 &p : body.points)
            form.most.push_back(p.x == x ? small : large);
        const std::vector<double> wanted(body.points.size(), large);
        return std::make_unique<Sized>(std::move(body), form, wanted);
    };
    constexpr double deep = 0.2;
    const auto at = [](const std::unique_ptr<Sized> &one, double x) { return one->sizing.at({x, 0.5, 0.5}); };
    const auto one = with_small_at(1.0, 2.0), parts = with_small_at(0.5, 0.5), beside = with_small_at(1.0, 0.5);
    const domain::SizingForm form;
    CHECK(at(one, 1.0 - deep) == doctest::Approx(small + form.inner_grade * deep));
    CHECK(at(parts, 0.5 + deep) == doctest::Approx(small + form.parted_grade * deep));
    CHECK(at(parts, 0.5 - deep) == doctest::Approx(small + form.parted_grade * deep));
    CHECK(at(beside, 1.0 - deep) == doctest::Approx(small + form.parted_grade * deep));
}

TEST_CASE("Sizing: edges on the hollow side of an interface wait before they grow, on both sides in a thin wall") {
    constexpr double small = 0.05, large = 0.11, deep = 0.04, flat = 0.35;
    const double grown = small + domain::SizingForm::parted_grade * deep;
    const double waited = small + domain::SizingForm::parted_grade * (deep - flat * small);
    for (const bool inner_first : {true, false}) // the interface's normals point either way
        for (const double wall : {0.1, 0.5}) {
            Body body = ball_in_ball(wall, inner_first);
            const auto [middle, out] = facet_inside(body);
            domain::SizingForm form;
            form.tolerance = 0.01;
            for (const Vec3 &p : body.points)
                form.most.push_back(norm(p) < 0.501 ? small : large);
            const std::vector<double> wanted(body.points.size(), large);
            const Sized one(std::move(body), form, wanted);
            CHECK(one.sizing.at(middle - deep * out) == doctest::Approx(waited));
            CHECK(one.sizing.at(middle + deep * out) == doctest::Approx(wall < 0.2 ? waited : grown));
        }
}

TEST_CASE("Sizing: a layer is as thick between an interface and the outside, whichever way the interface looks") {
    constexpr double thick = 0.125, share = 0.8; // edges wanted are too short for one row of tets
    for (const int numbers : {0, 1}) {
        Body body = cube(8, 0.0, 1, 1.0 - thick);
        for (int &region : body.regions)
            region = numbers == 0 ? region : 1 - region;
        body = stratified(body.points, body.tets, body.regions, facing);
        domain::SizingForm form;
        form.tolerance = 1e-3;
        const std::vector<double> wanted(body.points.size(), thick);
        const Sized one(std::move(body), form, wanted);
        for (const double x : {1.0 - thick, 1.0})
            CHECK(one.sizing.at({x, 0.5, 0.5}) == doctest::Approx(share * thick));
        CHECK(one.sizing.at({0.0, 0.5, 0.5}) == doctest::Approx(thick));
    }
}

TEST_CASE("Sizing: one row goes through a layer where long edges are wanted, and beyond its interface they wait") {
    constexpr double thick = 0.0625, share = 0.8, row = 1.4, deep = 0.05;
    const Body body = cube(16, 0.0, 1, 1.0 - thick);
    domain::SizingForm form;
    form.tolerance = 1e-3;
    for (const bool coarse : {false, true}) {
        const std::vector<double> wanted(body.points.size(), (coarse ? 2.0 : 1.6) * thick);
        const Sized one(body, form, wanted);
        const double size = (coarse ? row : share) * thick;
        for (const double x : {1.0 - thick, 1.0})
            CHECK(one.sizing.at({x, 0.5, 0.5}) == doctest::Approx(size));
        // Two rows are a wall: they wait between its sides, and beyond it nothing does.
        const double beyond = one.sizing.at({1.0 - thick - deep, 0.5, 0.5});
        CHECK(beyond == doctest::Approx(coarse ? size + domain::SizingForm::inner_grade * (deep - 0.5 * thick)
                                               : size + domain::SizingForm::parted_grade * deep));
        const double between = one.sizing.at({1.0 - 0.5 * thick, 0.5, 0.5});
        CHECK(between == doctest::Approx(coarse ? size + domain::SizingForm::inner_grade * 0.5 * thick : size));
    }
}

TEST_CASE("Sizing: three rows may go through a layer instead of one, and nowhere else") {
    constexpr double thick = 0.0625, share = 0.8;
    const double three_rows = 1.05 / (3.0 * std::sqrt(0.5)); // (110) planes of a lattice of cells of 1 / 1.05 edges
    const Body body = cube(16, 0.0, 1, 1.0 - thick);
    domain::SizingForm form;
    form.tolerance = 1e-3;
    form.one_row = false;
    for (const bool coarse : {false, true}) {
        const std::vector<double> wanted(body.points.size(), (coarse ? 2.0 : 1.6) * thick);
        const Sized one(body, form, wanted);
        CHECK(one.sizing.has_rows() == coarse);
        for (const double x : {1.0 - thick, 1.0})
            CHECK(one.sizing.at({x, 0.5, 0.5}) == doctest::Approx((coarse ? three_rows : share) * thick).epsilon(0.01));
        for (int v = 0; v < static_cast<int>(body.points.size()); ++v)
            CHECK(one.sizing.layer(v) == 0.0);
    }
    // Where no interface is a side of the layer one row comes right.
    form.tolerance = 6e-3;
    const Sized plate(bent_plate(0.06), form, std::vector<double>(13 * 13 * 13, 0.4));
    CHECK_FALSE(plate.sizing.has_rows());
    CHECK(plate.sizing.at({0.0, 1.03, 0.5}) == doctest::Approx(1.4 * 0.06).epsilon(0.02));
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
