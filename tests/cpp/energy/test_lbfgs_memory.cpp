#include "energy/lbfgs_memory.h"

#include "base/random.h"

#include <doctest/doctest.h>

#include <cmath>

namespace wct::tests {

using energy::Field;
using energy::LbfgsMemory;

namespace {

Field random_field(std::size_t count, Random &random) {
    Field out;
    for (std::size_t i = 0; i < count; ++i)
        out.push_back(random.normal3());
    return out;
}

/// A x for the matrix of springs between neighbours and to the origin, with other stiffness along each axis.
Field springs(const Field &x) {
    Field out(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        out[i] = {1.0 * x[i].x, 3.0 * x[i].y, 9.0 * x[i].z};
        if (i > 0)
            out[i] += 2.0 * (x[i] - x[i - 1]);
        if (i + 1 < x.size())
            out[i] += 2.0 * (x[i] - x[i + 1]);
    }
    return out;
}

} // namespace

TEST_CASE("Fields: inner product, sum, longest") {
    const Field a{{1, 2, 3}, {0, -4, 0}}, b{{2, 0, 1}, {5, 1, 7}};
    CHECK(energy::inner(a, b) == 1.0);
    CHECK(energy::longest(a) == 4.0);
    Field sum = a;
    energy::add(sum, 2.0, b);
    CHECK(sum == Field{{5, 2, 5}, {10, -2, 14}});
}

TEST_CASE("LbfgsMemory: the last pair meets the secant equation") {
    Random random(1);
    for (int pairs = 1; pairs <= 12; ++pairs) {
        LbfgsMemory memory(5);
        Field step, change;
        for (int k = 0; k < pairs; ++k) {
            step = random_field(4, random);
            change = springs(step);
            memory.remember(step, change);
        }
        const Field found = memory.direction(change); // minus the inverse Hessian times the change is minus the step
        for (std::size_t i = 0; i < step.size(); ++i)
            CHECK(norm(found[i] + step[i]) < 1e-12 * norm(step[i]) + 1e-13);
    }
}

TEST_CASE("LbfgsMemory: after as many conjugate steps as there are unknowns it is Newton's method") {
    // Steps along the eigenvectors of a diagonal matrix: all of the inverse is known then.
    LbfgsMemory memory(6);
    const double stiffness[6] = {1, 2, 4, 8, 16, 32};
    for (int k = 0; k < 6; ++k) {
        Field step(2), change(2);
        double *at[6] = {&step[0].x, &step[0].y, &step[0].z, &step[1].x, &step[1].y, &step[1].z};
        double *to[6] = {&change[0].x, &change[0].y, &change[0].z, &change[1].x, &change[1].y, &change[1].z};
        *at[k] = 0.5;
        *to[k] = 0.5 * stiffness[k];
        memory.remember(step, change);
    }
    const Field found = memory.direction({{1, 2, 4}, {8, 16, 32}});
    for (const Vec3 &v : found)
        CHECK(norm(v - Vec3{-1, -1, -1}) < 1e-14);
}

TEST_CASE("LbfgsMemory: minimises a quadratic in fewer steps than steepest descent comes near it") {
    Random random(2);
    const Field target = random_field(20, random);
    Field x(20), gradient = springs(x);
    energy::add(gradient, -1.0, springs(target));
    LbfgsMemory memory(8);
    int steps = 0;
    while (std::sqrt(energy::inner(gradient, gradient)) > 1e-9 && steps < 200) {
        Field step = gradient;
        if (memory.empty())
            for (Vec3 &v : step)
                v = -1.0 * v;
        else
            step = memory.direction(gradient);
        CHECK(energy::inner(step, gradient) < 0.0);
        // The minimum along the step.
        const double length = -energy::inner(step, gradient) / energy::inner(step, springs(step));
        const Field from = x, before = gradient;
        energy::add(x, length, step);
        gradient = springs(x);
        energy::add(gradient, -1.0, springs(target));
        memory.remember(from, x, before, gradient);
        ++steps;
    }
    CHECK(steps < 50);
    energy::add(x, -1.0, target);
    CHECK(energy::longest(x) < 1e-9);
}

TEST_CASE("LbfgsMemory: steps along which the energy does not curve upwards are not remembered") {
    LbfgsMemory memory(3);
    memory.remember(Field{{1, 0, 0}}, Field{{-1, 0, 0}});
    CHECK(memory.empty());
    memory.remember(Field{{1, 0, 0}}, Field{{0, 1, 0}});
    CHECK(memory.empty());
    memory.remember(Field{{1, 0, 0}}, Field{{2, 0, 0}});
    CHECK_FALSE(memory.empty());
    memory.clear();
    CHECK(memory.empty());
}

} // namespace wct::tests
