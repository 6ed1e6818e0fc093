// A cube of shaken tets is made well-centered, and the result is checked by other means than the library's.
#include <wct/well_center.h>

#include <algorithm>
#include <cstdio>
#include <random>

using Point = std::array<double, 3>;
using Tet = std::array<int, 4>;

// Are the circumcenter's barycentric coordinates positive? They are polynomials in the squares of the edges.
bool contains_circumcenter(const std::vector<Point> &points, const Tet &tet) {
    const auto square = [&](int i, int j) {
        const Point &p = points[tet[i % 4]], &q = points[tet[j % 4]];
        return (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]);
    };
    const auto coordinate = [&](int i) {
        const double a = square(i + 2, i + 3), b = square(i + 1, i + 3), c = square(i + 1, i + 2);
        return square(i, i + 1) * a * (b + c - a) + square(i, i + 2) * b * (a + c - b) +
               square(i, i + 3) * c * (a + b - c) - 2.0 * a * b * c;
    };
    return coordinate(0) > 0.0 && coordinate(1) > 0.0 && coordinate(2) > 0.0 && coordinate(3) > 0.0;
}

int main() {
    constexpr int n = 4, y = n + 1, x = y * y; // n cells along an edge; steps from a point to the next ones
    std::mt19937 random(1);
    const auto shaken = [&](int k) { return (k + (k % n ? 0.2 * (random() / 4294967296.0 - 0.5) : 0.0)) / n; };
    std::vector<Point> points; // those on a face of the cube stay on it
    for (int v = 0; v < x * y; ++v)
        points.push_back({shaken(v / x), shaken(v / y % y), shaken(v % y)});
    constexpr int ways[6][2] = {{x, x + y}, {y, y + 1}, {1, 1 + x}, {y + x, y}, {x + 1, x}, {1 + y, 1}};
    std::vector<Tet> tets; // six in a cell, along the ways from corner to corner
    for (int cell = 0; cell < n * n * n; ++cell)
        for (const auto &[a, b] : ways) {
            const int from = cell / (n * n) * x + cell / n % n * y + cell % n;
            tets.push_back({from, from + a, from + b, from + x + y + 1});
        }

    const wct::WellCenterResult made = wct::well_center({.points = points, .tets = tets});

    const auto bad = [](const std::vector<Point> &at, const std::vector<Tet> &of) {
        return std::count_if(of.begin(), of.end(), [&](const Tet &tet) { return !contains_circumcenter(at, tet); });
    };
    std::printf("before: %td of %zu tets do not contain their circumcenter\n", bad(points, tets), tets.size());
    std::printf("after:  %td of %zu\n", bad(made.points, made.tets), made.tets.size());
    return bad(made.points, made.tets) == 0 && made.metrics.reached ? 0 : 1;
}
