#include "geometry/predicates.h"

#include "base/random.h"
#include "support/big_integer.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace wct::tests {

using geometry::insphere;
using geometry::orient3d;

namespace {

// Signs from whole numbers, by Leibniz' sum over permutations and by Gram's matrix: not the formulas of the predicates.

using Long = __int128;
template <class T> using Point = std::array<T, 3>;

int sign(Long x) {
    return (x > 0) - (x < 0);
}
int sign(const BigInteger &x) {
    return x.sign();
}

template <class T> T determinant2(const T &a, const T &b, const T &c, const T &d) {
    return a * d - b * c;
}
template <class T> T determinant3(const std::array<Point<T>, 3> &m) {
    return m[0][0] * determinant2(m[1][1], m[1][2], m[2][1], m[2][2]) -
           m[0][1] * determinant2(m[1][0], m[1][2], m[2][0], m[2][2]) +
           m[0][2] * determinant2(m[1][0], m[1][1], m[2][0], m[2][1]);
}
template <class T> Point<T> minus(const Point<T> &a, const Point<T> &b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T> T inner(const Point<T> &a, const Point<T> &b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class T> int side_of(const std::array<Point<T>, 4> &p) {
    return sign(determinant3<T>({minus(p[1], p[0]), minus(p[2], p[0]), minus(p[3], p[0])}));
}

/// Expanded along the column of squared lengths.
template <class T> int sphere_of(const std::array<Point<T>, 5> &p) {
    std::array<Point<T>, 4> rows;
    for (int i = 0; i < 4; ++i)
        rows[i] = minus(p[i], p[4]);
    T sum(0);
    for (int i = 0; i < 4; ++i) {
        std::array<Point<T>, 3> others;
        for (int k = 0, at = 0; k < 4; ++k)
            if (k != i)
                others[at++] = rows[k];
        const T term = inner(rows[i], rows[i]) * determinant3<T>(others);
        sum = i % 2 == 0 ? sum + term : sum - term;
    }
    return sign(sum); // positive inside a positive tet
}

/// The circumcenter's weights of the last three corners are x with G x = diagonal(G) / 2, G the edges' Gram matrix.
template <class T> bool holds_circumcenter(const std::array<Point<T>, 4> &p) {
    std::array<Point<T>, 3> edges, gram;
    for (int i = 0; i < 3; ++i)
        edges[i] = minus(p[i + 1], p[0]);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            gram[i][j] = inner(edges[i], edges[j]);
    T left = determinant3<T>(gram) + determinant3<T>(gram);
    for (int i = 0; i < 3; ++i) { // Cramer
        std::array<Point<T>, 3> changed = gram;
        for (int k = 0; k < 3; ++k)
            changed[k][i] = gram[k][k];
        const T weight = determinant3<T>(changed);
        if (sign(weight) <= 0)
            return false;
        left = left - weight;
    }
    return sign(left) > 0;
}

template <class T> bool has_acute_angles(const std::array<Point<T>, 3> &p) {
    std::array<T, 3> squares;
    for (int i = 0; i < 3; ++i) {
        const Point<T> edge = minus(p[(i + 1) % 3], p[i]);
        squares[i] = inner(edge, edge);
    }
    for (int i = 0; i < 3; ++i) // Pythagoras
        if (sign(squares[i] + squares[(i + 1) % 3] - squares[(i + 2) % 3]) <= 0)
            return false;
    return true;
}

/// The facets at edge i j meet acutely where the other two corners, seen along the edge, span an acute angle.
template <class T> bool has_acute_dihedral_angles(const std::array<Point<T>, 4> &p) {
    for (int i = 0; i < 4; ++i)
        for (int j = i + 1; j < 4; ++j) {
            const int k = i != 0 && j != 0 ? 0 : i != 1 && j != 1 ? 1 : 2;
            const int l = 6 - i - j - k;
            const Point<T> e = minus(p[j], p[i]), a = minus(p[k], p[i]), b = minus(p[l], p[i]);
            // |e|^2 a . b - (a . e)(b . e), the dot product of what of a and b is normal to e, times |e|^2
            if (sign(inner(e, e) * inner(a, b) - inner(a, e) * inner(b, e)) <= 0)
                return false;
        }
    return true;
}

Vec3 real(const Point<Long> &p, int ex, int ey, int ez) {
    return {std::ldexp(static_cast<double>(p[0]), ex), std::ldexp(static_cast<double>(p[1]), ey),
            std::ldexp(static_cast<double>(p[2]), ez)};
}

/// All points over the greatest power of two that divides all of their coordinates.
template <std::size_t n> std::array<Point<BigInteger>, n> whole(const std::array<Vec3, n> &points) {
    int least = 1100;
    for (const Vec3 &p : points)
        for (const double x : {p.x, p.y, p.z})
            if (x != 0.0)
                least = std::min(least, std::max(std::ilogb(x) - 52, -1074));
    std::array<Point<BigInteger>, n> out;
    for (std::size_t i = 0; i < n; ++i)
        out[i] = {BigInteger::scaled(points[i].x, least), BigInteger::scaled(points[i].y, least),
                  BigInteger::scaled(points[i].z, least)};
    return out;
}

Point<Long> any_point(Random &random, int most) {
    return {random.below(2 * most + 1) - most, random.below(2 * most + 1) - most, random.below(2 * most + 1) - most};
}

/// In the plane of three others, or one step off it.
Point<Long> nearly_in_plane(const std::array<Point<Long>, 3> &p, Random &random) {
    const int i = random.below(7) - 3, j = random.below(7) - 3;
    Point<Long> out;
    for (int k = 0; k < 3; ++k)
        out[k] = p[0][k] + i * (p[1][k] - p[0][k]) + j * (p[2][k] - p[0][k]);
    out[random.below(3)] += random.below(3) - 1;
    return out;
}

/// All whole points with x^2 + y^2 + z^2 = square.
std::vector<Point<Long>> on_sphere(int square) {
    std::vector<Point<Long>> points;
    const int most = static_cast<int>(std::sqrt(square));
    for (int x = -most; x <= most; ++x)
        for (int y = -most; y <= most; ++y)
            for (int z = -most; z <= most; ++z)
                if (x * x + y * y + z * z == square)
                    points.push_back({x, y, z});
    return points;
}

} // namespace

TEST_CASE("orient3d: 600 000 tets of whole numbers, many of them flat, at scales from the smallest doubles on") {
    Random random(1);
    int zeros = 0, wrong = 0;
    for (int k = 0; k < 600000; ++k) {
        const int most = k % 3 == 0 ? 3 : k % 3 == 1 ? 300 : 1 << 20;
        std::array<Point<Long>, 4> p{any_point(random, most), any_point(random, most), any_point(random, most), {}};
        p[3] = k % 2 ? any_point(random, most) : nearly_in_plane({p[0], p[1], p[2]}, random);
        std::swap(p[3], p[random.below(4)]);
        // Each axis may have a unit of its own: that leaves the sign.
        const int ex = random.below(2000) - 1074, ey = k % 5 ? ex : random.below(2000) - 1074;
        const int ez = k % 5 ? ex : random.below(2000) - 1074;
        const int is =
            orient3d(real(p[0], ex, ey, ez), real(p[1], ex, ey, ez), real(p[2], ex, ey, ez), real(p[3], ex, ey, ez));
        const int wanted = side_of<Long>(p);
        zeros += wanted == 0;
        wrong += is != wanted;
    }
    CHECK(wrong == 0);
    CHECK(zeros > 50000);
}

TEST_CASE("insphere: 400 000 of whole numbers, many of them on one sphere") {
    Random random(2);
    const std::vector<Point<Long>> sphere = on_sphere(1105 * 9);
    REQUIRE(sphere.size() > 100);
    int zeros = 0, wrong = 0;
    for (int k = 0; k < 400000; ++k) {
        const int most = k % 3 == 0 ? 2 : k % 3 == 1 ? 200 : 1 << 18;
        std::array<Point<Long>, 5> p;
        const Point<Long> origin = any_point(random, 1 << 18);
        for (Point<Long> &q : p)
            q = any_point(random, most);
        if (k % 4 == 0)
            for (Point<Long> &q : p) {
                q = sphere[random.below(static_cast<int>(sphere.size()))];
                for (int i = 0; i < 3; ++i)
                    q[i] += origin[i];
            }
        if (k % 8 == 0)
            p[random.below(5)][random.below(3)] += random.below(3) - 1;
        const int e = random.below(2000) - 1074;
        std::array<Vec3, 5> x;
        for (int i = 0; i < 5; ++i)
            x[i] = real(p[i], e, e, e);
        const int wanted = sphere_of<Long>(p);
        zeros += wanted == 0;
        wrong += insphere(x[0], x[1], x[2], x[3], x[4]) != wanted;
    }
    CHECK(wrong == 0);
    CHECK(zeros > 50000);
}

TEST_CASE("Predicates on doubles with all their bits, as near to zero as rounding gets them") {
    Random random(3);
    int wrong = 0;
    for (int k = 0; k < 6000; ++k) {
        std::array<Vec3, 5> p;
        const int spread = k % 3 == 0 ? 0 : k % 3 == 1 ? 40 : 300;
        for (Vec3 &q : p) {
            q = random.normal3();
            if (spread)
                q = {std::ldexp(q.x, random.below(2 * spread) - spread), std::ldexp(q.y, random.below(spread)), q.z};
        }
        const Vec3 away = 100.0 * random.normal3();
        if (k % 2) { // rounded into one plane, then far off the origin
            const double u = random.normal(), v = random.normal();
            p[3] = p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]);
            for (Vec3 &q : p)
                q += away;
        }
        const auto exact = whole<4>({p[0], p[1], p[2], p[3]});
        wrong += orient3d(p[0], p[1], p[2], p[3]) != side_of<BigInteger>(exact);
        if (k % 4 == 1) // rounded onto one sphere
            for (Vec3 &q : p)
                q = unit(random.normal3()) + away;
        wrong += insphere(p[0], p[1], p[2], p[3], p[4]) != sphere_of<BigInteger>(whole<5>(p));
    }
    CHECK(wrong == 0);
}

TEST_CASE("orient3d: what may be lost counts in every term of the determinant") {
    // One edge is long along an axis, but for as little as rounding loses; the others are nearly parallel as seen along
    // it, so that its term loses all its digits, and the next decides.
    Random random(5);
    int wrong = 0, lost = 0;
    for (int k = 0; k < 30000; ++k) {
        const double along = std::ldexp(1.0 + random.uniform(), random.below(80) - 20);
        const double size = std::ldexp(1.0, random.below(40) - 10), times = random.normal();
        const double v1 = size * random.normal(), v2 = size * random.normal();
        const Vec3 rows[3] = {{along, along * 0x1p-53 * random.normal(), 0.0},
                              {size * random.normal(), v1, v2},
                              {size * random.normal(), times * v1, times * v2}};
        std::array<Vec3, 4> p{}; // the first is the origin, so that differences are exact
        for (int i = 0; i < 3; ++i) {
            const auto &[x, y, z] = rows[i];
            p[i + 1] = k % 3 == 0 ? Vec3{x, y, z} : k % 3 == 1 ? Vec3{z, x, y} : Vec3{y, z, x};
        }
        const int wanted = side_of<BigInteger>(whole<4>(p));
        wrong += orient3d(p[0], p[1], p[2], p[3]) != wanted;
        lost += (dot(p[1], cross(p[2], p[3])) > 0.0) != (wanted > 0);
    }
    CHECK(wrong == 0);
    CHECK(lost > 1000); // so often rounding alone has another sign
}

TEST_CASE("Predicates where differences of coordinates overflow or are lost") {
    const double huge = 1.7e308, tiny = 5e-324;
    const Vec3 o{-huge, -huge, -huge}, x{huge, -huge, -huge}, y{-huge, huge, -huge}, z{-huge, -huge, huge};
    CHECK(orient3d(o, x, y, z) == 1);
    CHECK(orient3d(o, y, x, z) == -1);
    CHECK(insphere(o, x, y, z, {huge, huge, huge}) == 0);
    CHECK(insphere(o, x, y, z, {huge, huge, 0.0}) == 1);
    CHECK(orient3d({0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}, {0, 0, tiny}) == 1);
    CHECK(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {huge, huge, tiny}) == 1);
    CHECK(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {huge, huge, -tiny}) == -1);
    CHECK(insphere({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}) == 0);
    CHECK(insphere({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1 - 0x1p-53}) == 1);
    CHECK(insphere({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1 + 0x1p-52}) == -1);
}

TEST_CASE("A tet contains its circumcenter, a triangle and dihedral angles are acute, exactly") {
    Random random(4);
    int inside = 0, acute = 0, sharp = 0, wrong = 0;
    for (int k = 0; k < 40000; ++k) {
        const int most = k % 2 ? 3 : 40; // small ones have centers on facets, and right angles
        std::array<Point<Long>, 4> p;
        for (Point<Long> &q : p)
            q = any_point(random, most);
        if (side_of<Long>(p) < 0)
            std::swap(p[0], p[1]);
        const int e = random.below(400) - 200;
        std::array<Vec3, 4> x;
        for (int i = 0; i < 4; ++i)
            x[i] = real(p[i], e, e, e);
        if (side_of<Long>(p) > 0) {
            const bool wanted = holds_circumcenter<Long>(p);
            inside += wanted;
            wrong += geometry::contains_circumcenter(x[0], x[1], x[2], x[3]) != wanted;
            const bool dihedral = has_acute_dihedral_angles<Long>(p);
            sharp += dihedral;
            wrong += geometry::dihedral_angles_acute(x[0], x[1], x[2], x[3]) != dihedral;
            wrong += geometry::dihedral_angles_acute(x[1], x[0], x[2], x[3]) != dihedral; // inverted
        }
        const bool wanted = has_acute_angles<Long>({p[0], p[1], p[2]});
        acute += wanted;
        wrong += geometry::acute(x[0], x[1], x[2]) != wanted;
    }
    CHECK(wrong == 0);
    CHECK(inside > 200);
    CHECK(acute > 5000);
    CHECK(sharp > 200);
}

TEST_CASE("Tets of all digits and of far apart magnitudes are judged by the same rules") {
    Random random(14);
    int inside = 0, sharp = 0, wrong = 0;
    for (int k = 0; k < 3000; ++k) {
        // Regular but for noise; every third with a corner whose lowest digit is far below the others' highest.
        std::array<Vec3, 4> x{Vec3{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
        for (Vec3 &p : x)
            p += 0.25 * random.normal3();
        if (k % 3 == 0)
            x[random.below(4)].x += 0x1p-80;
        if (k % 3 == 1)
            x[random.below(4)].y = 0x1p-70;
        if (geometry::orient3d(x[0], x[1], x[2], x[3]) < 0)
            std::swap(x[0], x[1]);
        const auto p = whole(x);
        const bool holds = holds_circumcenter<BigInteger>(p);
        const bool dihedral = has_acute_dihedral_angles<BigInteger>(p);
        inside += holds;
        sharp += dihedral;
        wrong += geometry::contains_circumcenter(x[0], x[1], x[2], x[3]) != holds;
        wrong += geometry::dihedral_angles_acute(x[0], x[1], x[2], x[3]) != dihedral;
        wrong += geometry::acute(x[0], x[1], x[2]) != has_acute_angles<BigInteger>({p[0], p[1], p[2]});
    }
    CHECK(wrong == 0);
    CHECK(inside > 500);
    CHECK(sharp > 500);
}

TEST_CASE("What surely_positive says of a rounded flatness is so") {
    Random random(5);
    for (int k = 0; k < 20000; ++k) {
        std::array<Vec3, 4> p{random.normal3(), random.normal3(), random.normal3(), {}};
        const double u = random.normal(), v = random.normal(), off = std::ldexp(random.normal(), -random.below(60));
        p[3] = p[0] + u * (p[1] - p[0]) + v * (p[2] - p[0]) + off * random.normal3();
        double longest = 0.0;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < i; ++j)
                longest = std::max(longest, norm(p[i] - p[j]));
        const double det = dot(p[1] - p[0], cross(p[2] - p[0], p[3] - p[0]));
        if (geometry::surely_positive(det / (longest * longest * longest)))
            REQUIRE(orient3d(p[0], p[1], p[2], p[3]) == 1);
    }
}

} // namespace wct::tests
