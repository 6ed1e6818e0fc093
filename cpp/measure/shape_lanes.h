#pragma once

#include "base/cells.h"
#include "base/multiversion.h"
#include "base/vec3.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace wct::measure {

/// So many tets are measured together, one per lane of a vector register.
inline constexpr int kLanes = 8;
using Lanes = std::array<double, kLanes>;

/// The corners of some tets, a lane each, in the order that the tets name them; the last one again in lanes without.
struct CornerLanes {
    alignas(64) std::array<std::array<Lanes, 3>, 4> at;

    CornerLanes(const std::vector<Vec3> &points, const std::vector<Tet> &tets, std::size_t first) {
        for (int lane = 0; lane < kLanes; ++lane) {
            const Tet &tet = tets[std::min(first + lane, tets.size() - 1)];
            for (int i = 0; i < 4; ++i) {
                const Vec3 &p = points[tet[i]];
                at[i][0][lane] = p.x;
                at[i][1][lane] = p.y;
                at[i][2][lane] = p.z;
            }
        }
    }

    WCT_INLINE Vec3 corner(int i, int lane) const { return {at[i][0][lane], at[i][1][lane], at[i][2][lane]}; }
};

WCT_INLINE void swap_if(bool really, double &a, double &b) {
    const double held = really ? b : a;
    b = really ? a : b;
    a = held;
}

WCT_INLINE void swap_if(bool really, Vec3 &a, Vec3 &b) {
    swap_if(really, a.x, b.x);
    swap_if(really, a.y, b.y);
    swap_if(really, a.z, b.z);
}

/// The polynomials behind all measures of one tet, renumbered by i -> i xor `base` so that the edges from corner 0 are
/// the shortest: rounding errors are least then. That is an even permutation and its own inverse.
struct Shape {
    int base;
    Vec3 u, v, w;         // edges 01 02 03
    Vec3 e12, e13, e23;   // the others
    double s01, s02, s03; // their squared lengths
    double s12, s13, s23;
    Vec3 n0, n1, n2, n3;   // inward normals of the facets, twice their areas long
    double a0, a1, a2, a3; // their lengths
    double det;            // six volumes
    Vec3 q;                // the circumcenter seen from corner 0, times 2 det
    double p0, p1, p2, p3; // its heights over the facets, times 2 det and twice the facet's area

    WCT_INLINE Shape(Vec3 x0, Vec3 x1, Vec3 x2, Vec3 x3) {
        const double s[6] = {square(x1 - x0), square(x2 - x0), square(x3 - x0),
                             square(x2 - x1), square(x3 - x1), square(x3 - x2)};
        double least = s[0] + s[1] + s[2];
        base = 0;
        const auto try_base = [&](int corner, double sum) {
            base = sum < least ? corner : base;
            least = sum < least ? sum : least;
        };
        try_base(1, s[0] + s[3] + s[4]);
        try_base(2, s[1] + s[3] + s[5]);
        try_base(3, s[2] + s[4] + s[5]);
        swap_if(base & 1, x0, x1);
        swap_if(base & 1, x2, x3);
        swap_if(base & 2, x0, x2);
        swap_if(base & 2, x1, x3);
        u = x1 - x0;
        v = x2 - x0;
        w = x3 - x0;
        e12 = x2 - x1;
        e13 = x3 - x1;
        e23 = x3 - x2;
        s01 = square(u);
        s02 = square(v);
        s03 = square(w);
        s12 = square(e12);
        s13 = square(e13);
        s23 = square(e23);
        n1 = cross(v, w);
        n2 = cross(w, u);
        n3 = cross(u, v);
        n0 = -1.0 * (n1 + n2 + n3);
        a0 = std::sqrt(square(n0));
        a1 = std::sqrt(square(n1));
        a2 = std::sqrt(square(n2));
        a3 = std::sqrt(square(n3));
        det = dot(u, n1);
        q = s01 * n1 + s02 * n2 + s03 * n3;
        p0 = dot(n0, q) + 2.0 * det * det;
        p1 = dot(n1, q);
        p2 = dot(n2, q);
        p3 = dot(n3, q);
    }

    static WCT_INLINE double square(const Vec3 &a) { return dot(a, a); }

    WCT_INLINE double radius() const { return std::sqrt(square(q)) / (2.0 * std::fabs(det)); }
};

/// The cosines of the twelve facet angles, times the lengths of the edges that span them, facet by facet as kOutward
/// has its corners: visit(number, facet, value).
template <class Visit> WCT_INLINE void each_face_dot(const Shape &s, const Visit &visit) {
    visit(0, s.a0, dot(s.e12, s.e13));
    visit(1, s.a0, -dot(s.e12, s.e23));
    visit(2, s.a0, dot(s.e13, s.e23));
    visit(3, s.a1, dot(s.w, s.v));
    visit(4, s.a1, dot(s.w, s.e23));
    visit(5, s.a1, -dot(s.v, s.e23));
    visit(6, s.a2, dot(s.u, s.w));
    visit(7, s.a2, -dot(s.u, s.e13));
    visit(8, s.a2, dot(s.w, s.e13));
    visit(9, s.a3, dot(s.v, s.u));
    visit(10, s.a3, dot(s.v, s.e12));
    visit(11, s.a3, -dot(s.u, s.e12));
}

/// The cosines of the six dihedral angles, times the normals' lengths, as kEdges: visit(number, squared length of the
/// edge, value). |N_i x N_j| is |det| times the length of the edge that the two facets share.
template <class Visit> WCT_INLINE void each_dihedral_dot(const Shape &s, const Visit &visit) {
    const double d12 = dot(s.n1, s.n2);
    const double d13 = dot(s.n1, s.n3);
    const double d23 = dot(s.n2, s.n3);
    const double d01 = -(dot(s.n1, s.n1) + d12 + d13);
    const double d02 = -(d12 + dot(s.n2, s.n2) + d23);
    const double d03 = -(d13 + d23 + dot(s.n3, s.n3));
    visit(0, s.s01, -d23);
    visit(1, s.s02, -d13);
    visit(2, s.s03, -d12);
    visit(3, s.s12, -d03);
    visit(4, s.s13, -d02);
    visit(5, s.s23, -d01);
}

/// The greatest power of two, as an exponent, that the coordinates are below, and the points divided by it: in the unit
/// cube no unit of length under- or overflows.
struct UnitCube {
    int exponent = 0;
    std::vector<Vec3> points;

    explicit UnitCube(const std::vector<Vec3> &given) : points(given) {
        double largest = 0.0;
        for (const Vec3 &p : given)
            largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
        std::frexp(largest, &exponent);
        for (Vec3 &p : points)
            p = {std::ldexp(p.x, -exponent), std::ldexp(p.y, -exponent), std::ldexp(p.z, -exponent)};
    }
};

} // namespace wct::measure
