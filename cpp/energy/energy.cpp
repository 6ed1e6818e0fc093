#include "energy/energy.h"

#include "base/lane_extremes.h"
#include "base/multiversion.h"

#include <cmath>
#include <limits>

namespace wct::energy {

namespace {

WCT_INLINE double signed_square(double a) {
    return a * std::fabs(a);
}
WCT_INLINE double signed_root(double a) {
    return std::copysign(std::sqrt(std::fabs(a)), a);
}
WCT_INLINE Vec3 load(const Lanes v[3], int lane) {
    return {v[0][lane], v[1][lane], v[2][lane]};
}
WCT_INLINE void store(Lanes v[3], int lane, const Vec3 &value) {
    v[0][lane] = value.x;
    v[1][lane] = value.y;
    v[2][lane] = value.z;
}

/// Weights that write a triangle's circumcenter in its corners, before division by 16 area^2: corner a against the
/// squared edges opposite a, b and c.
WCT_INLINE double corner_weight(double a, double b, double c) {
    return a * (b + c - a);
}

struct Pull {
    Vec3 center;      // dE/d(circumcenter)
    Vec3 radial;      // its part through R, which corner 0 also feels with the opposite sign
    double scaled[4]; // dE/dh over each facet
};

WCT_INLINE Pull pull_on_center(const ShapeLanes &s, const SlopeLanes &slopes, int lane) {
    Pull pull{};
    double along = 0.0;
    for (int i = 0; i < 4; ++i) {
        pull.scaled[i] = slopes.height[i][lane] * s.inverse_radius[lane];
        pull.center += pull.scaled[i] * load(s.normal[i], lane);
        along -= pull.scaled[i] * s.height[i][lane];
    }
    pull.radial = (along * s.inverse_radius[lane]) * load(s.center, lane);
    pull.center += pull.radial;
    return pull;
}

/// Lengths of one tet's edges, numbered 01 02 03 12 13 23.
struct Edges {
    double square[6];
    double inverse[6];
};

WCT_INLINE Edges edges_of(const Lanes *square, int lane) {
    Edges e;
    for (int i = 0; i < 6; ++i) {
        e.square[i] = square[i].at[lane];
        e.inverse[i] = 1.0 / std::sqrt(e.square[i]);
    }
    return e;
}

/// Cosine of the angle between edges p and q, which faces edge r.
WCT_INLINE double cosine(const Edges &e, int p, int q, int r) {
    return 0.5 * (e.square[p] + e.square[q] - e.square[r]) * (e.inverse[p] * e.inverse[q]);
}

/// The twelve facet angles, facet by facet: calls visit(number, p, q, r) with each angle's edges. Written out, since a
/// loop over them would keep the compiler from seeing one straight computation per lane.
#define WCT_EACH_ANGLE(visit)                                                                                          \
    visit(0, 3, 4, 5);                                                                                                 \
    visit(1, 3, 5, 4);                                                                                                 \
    visit(2, 4, 5, 3);                                                                                                 \
    visit(3, 1, 2, 5);                                                                                                 \
    visit(4, 1, 5, 2);                                                                                                 \
    visit(5, 2, 5, 1);                                                                                                 \
    visit(6, 0, 2, 4);                                                                                                 \
    visit(7, 0, 4, 2);                                                                                                 \
    visit(8, 2, 4, 0);                                                                                                 \
    visit(9, 0, 1, 3);                                                                                                 \
    visit(10, 0, 3, 1);                                                                                                \
    visit(11, 1, 3, 0)

/// dE/d(squared edges) of one tet, from the slope of one cosine: cos = (p + q - r) / (2 sqrt(p q)) in squared edges.
WCT_INLINE void pull_angle(double slope, double cosine, const double *inverse, int p, int q, int r, double *pull) {
    const double half = 0.5 * slope * (inverse[p] * inverse[q]);
    const double turn = 0.5 * slope * cosine;
    pull[p] += half - turn * (inverse[p] * inverse[p]);
    pull[q] += half - turn * (inverse[q] * inverse[q]);
    pull[r] -= half;
}

struct EdgePull {
    double on[6];
};

WCT_INLINE EdgePull pull_on_edges(const ShapeLanes &s, const SlopeLanes &slopes, int lane) {
    double inverse[6];
    for (int i = 0; i < 6; ++i)
        inverse[i] = s.inverse_edge[i].at[lane];
    EdgePull pull{};
#define WCT_PULL(k, p, q, r) pull_angle(slopes.cosine[k].at[lane], s.cosine[k].at[lane], inverse, p, q, r, pull.on)
    WCT_EACH_ANGLE(WCT_PULL);
#undef WCT_PULL
    return pull;
}

struct Core {
    Vec3 u, v, w, a, b, c; // edges from corner 0; v x w, w x u, u x v
    double det, uu, vv, ww, d12, d13, d23, longest;
};

WCT_INLINE Core core_of(const TetLanes &tets, int lane) {
    Core k;
    const Vec3 x0 = load(tets.corner[0], lane);
    k.u = load(tets.corner[1], lane) - x0;
    k.v = load(tets.corner[2], lane) - x0;
    k.w = load(tets.corner[3], lane) - x0;
    k.a = cross(k.v, k.w);
    k.b = cross(k.w, k.u);
    k.c = cross(k.u, k.v);
    k.det = dot(k.u, k.a);
    k.uu = dot(k.u, k.u);
    k.vv = dot(k.v, k.v);
    k.ww = dot(k.w, k.w);
    const Vec3 e12 = k.v - k.u;
    const Vec3 e13 = k.w - k.u;
    const Vec3 e23 = k.w - k.v;
    k.d12 = dot(e12, e12);
    k.d13 = dot(e13, e13);
    k.d23 = dot(e23, e23);
    k.longest = larger(larger(larger(k.uu, k.vv), larger(k.ww, k.d12)), larger(k.d13, k.d23));
    return k;
}

/// The determinant as divisor: an input tet flat beyond rounding gets a finite stand-in, so that nothing becomes NaN.
WCT_INLINE double divisor(const Core &k, double cube) {
    return larger(k.det, 1e-12 * cube);
}

/// Add dE/dx by way of the facet angles.
WCT_INLINE void differentiate_angles(const TetLanes *__restrict in, const ShapeLanes *__restrict s,
                                     const SlopeLanes *__restrict slope, GradientLanes *__restrict out) {
    for (int lane = 0; lane < kLanes; ++lane) {
        const EdgePull pull = pull_on_edges(*s, *slope, lane);
        const Vec3 x0 = load(in->corner[0], lane);
        const Vec3 x1 = load(in->corner[1], lane);
        const Vec3 x2 = load(in->corner[2], lane);
        const Vec3 x3 = load(in->corner[3], lane);
        const Vec3 p01 = (2.0 * pull.on[0]) * (x1 - x0);
        const Vec3 p02 = (2.0 * pull.on[1]) * (x2 - x0);
        const Vec3 p03 = (2.0 * pull.on[2]) * (x3 - x0);
        const Vec3 p12 = (2.0 * pull.on[3]) * (x2 - x1);
        const Vec3 p13 = (2.0 * pull.on[4]) * (x3 - x1);
        const Vec3 p23 = (2.0 * pull.on[5]) * (x3 - x2);
        store(out->corner[0], lane, load(out->corner[0], lane) - p01 - p02 - p03);
        store(out->corner[1], lane, load(out->corner[1], lane) + p01 - p12 - p13);
        store(out->corner[2], lane, load(out->corner[2], lane) + p02 + p12 - p23);
        store(out->corner[3], lane, load(out->corner[3], lane) + p03 + p13 + p23);
    }
}

} // namespace

WCT_MULTIVERSION
void measure(const TetLanes &tets, bool cosines, ShapeLanes &shape) {
    const TetLanes *__restrict in = &tets;
    ShapeLanes *__restrict out = &shape;
    for (int lane = 0; lane < kLanes; ++lane) {
        const Core k = core_of(*in, lane);
        const double cube = k.longest * std::sqrt(k.longest);
        out->flatness[lane] = k.det / cube;
        const double inverse_det = 1.0 / divisor(k, cube);
        const Vec3 r = (0.5 * inverse_det) * (k.uu * k.a + k.vv * k.b + k.ww * k.c);
        const double inverse_radius = 1.0 / norm(r);
        const Vec3 inward = Vec3{} - (k.a + k.b + k.c);
        const double s0 = 1.0 / dot(inward, inward);
        const double s1 = 1.0 / dot(k.a, k.a);
        const double s2 = 1.0 / dot(k.b, k.b);
        const double s3 = 1.0 / dot(k.c, k.c);
        const Vec3 n0 = std::sqrt(s0) * inward;
        const Vec3 n1 = std::sqrt(s1) * k.a;
        const Vec3 n2 = std::sqrt(s2) * k.b;
        const Vec3 n3 = std::sqrt(s3) * k.c;
        out->height[0][lane] = dot(n0, r - k.u) * inverse_radius;
        out->height[1][lane] = dot(n1, r) * inverse_radius;
        out->height[2][lane] = dot(n2, r) * inverse_radius;
        out->height[3][lane] = dot(n3, r) * inverse_radius;
        store(out->normal[0], lane, n0);
        store(out->normal[1], lane, n1);
        store(out->normal[2], lane, n2);
        store(out->normal[3], lane, n3);
        out->area_term[0][lane] = 0.25 * s0;
        out->area_term[1][lane] = 0.25 * s1;
        out->area_term[2][lane] = 0.25 * s2;
        out->area_term[3][lane] = 0.25 * s3;
        store(out->center, lane, r);
        out->inverse_radius[lane] = inverse_radius;
        out->inverse_det[lane] = inverse_det;
        out->square[0][lane] = k.uu;
        out->square[1][lane] = k.vv;
        out->square[2][lane] = k.ww;
        out->square[3][lane] = k.d12;
        out->square[4][lane] = k.d13;
        out->square[5][lane] = k.d23;
    }
    if (!cosines)
        return;
    for (int lane = 0; lane < kLanes; ++lane) {
        const Edges e = edges_of(out->square, lane);
        for (int i = 0; i < 6; ++i)
            out->inverse_edge[i].at[lane] = e.inverse[i];
#define WCT_STORE(k, p, q, r) out->cosine[k].at[lane] = cosine(e, p, q, r)
        WCT_EACH_ANGLE(WCT_STORE);
#undef WCT_STORE
    }
}

// The chain rule for h_i = n_i . (C - x_j), j any corner of facet i:
//   dh_i = n_i . dC - sum_k w_ik n_i . dx_k,  w_ik the barycentric coordinates of the facet's own circumcenter
// (the plane turns about the circumcenter's foot, which is the circumcenter of the facet), and for g = dE/dC:
//   y = A^-T g with A's rows x_j - x_0;  dE/dx_j += y_j (x_j - C),  dE/dx_0 += g - sum_j y_j (x_j - C)
// from differentiating |x_j - C|^2 = |x_0 - C|^2.

WCT_MULTIVERSION
void differentiate(const TetLanes &tets, const ShapeLanes &shape, const SlopeLanes &slopes, bool cosines,
                   GradientLanes &gradient) {
    const TetLanes *__restrict in = &tets;
    const ShapeLanes *__restrict s = &shape;
    const SlopeLanes *__restrict slope = &slopes;
    GradientLanes *__restrict out = &gradient;
    for (int lane = 0; lane < kLanes; ++lane) {
        const Pull pull = pull_on_center(*s, *slope, lane);
        const Vec3 r = load(s->center, lane);
        const Vec3 x0 = load(in->corner[0], lane);
        const Vec3 u = load(in->corner[1], lane) - x0;
        const Vec3 v = load(in->corner[2], lane) - x0;
        const Vec3 w = load(in->corner[3], lane) - x0;
        const double d01 = s->square[0][lane];
        const double d02 = s->square[1][lane];
        const double d03 = s->square[2][lane];
        const double d12 = s->square[3][lane];
        const double d13 = s->square[4][lane];
        const double d23 = s->square[5][lane];
        const Vec3 t0 = (pull.scaled[0] * s->area_term[0][lane]) * load(s->normal[0], lane);
        const Vec3 t1 = (pull.scaled[1] * s->area_term[1][lane]) * load(s->normal[1], lane);
        const Vec3 t2 = (pull.scaled[2] * s->area_term[2][lane]) * load(s->normal[2], lane);
        const Vec3 t3 = (pull.scaled[3] * s->area_term[3][lane]) * load(s->normal[3], lane);
        // y_j = (v x w, w x u, u x v)_j . g / det
        const Vec3 g = s->inverse_det[lane] * pull.center;
        const Vec3 on1 = dot(cross(v, w), g) * (u - r);
        const Vec3 on2 = dot(cross(w, u), g) * (v - r);
        const Vec3 on3 = dot(cross(u, v), g) * (w - r);
        store(out->corner[0], lane,
              pull.center - pull.radial - (on1 + on2 + on3) -
                  (corner_weight(d23, d03, d02) * t1 + corner_weight(d13, d03, d01) * t2 +
                   corner_weight(d12, d02, d01) * t3));
        store(out->corner[1], lane,
              on1 - (corner_weight(d23, d13, d12) * t0 + corner_weight(d03, d13, d01) * t2 +
                     corner_weight(d02, d12, d01) * t3));
        store(out->corner[2], lane,
              on2 - (corner_weight(d13, d23, d12) * t0 + corner_weight(d03, d23, d02) * t1 +
                     corner_weight(d01, d12, d02) * t3));
        store(out->corner[3], lane,
              on3 - (corner_weight(d12, d23, d13) * t0 + corner_weight(d02, d23, d03) * t1 +
                     corner_weight(d01, d13, d03) * t2));
    }
    if (cosines)
        differentiate_angles(in, s, slope, out);
}

WCT_MULTIVERSION
void differentiate_first(const TetLanes &tets, const ShapeLanes &shape, const SlopeLanes &slopes, bool cosines,
                         Lanes gradient[3]) {
    const TetLanes *__restrict in = &tets;
    const ShapeLanes *__restrict s = &shape;
    const SlopeLanes *__restrict slope = &slopes;
    Lanes *__restrict out = gradient;
    for (int lane = 0; lane < kLanes; ++lane) {
        const Pull pull = pull_on_center(*s, *slope, lane);
        const Vec3 r = load(s->center, lane);
        const Vec3 x0 = load(in->corner[0], lane);
        const Vec3 u = load(in->corner[1], lane) - x0;
        const Vec3 v = load(in->corner[2], lane) - x0;
        const Vec3 w = load(in->corner[3], lane) - x0;
        const double d01 = s->square[0][lane];
        const double d02 = s->square[1][lane];
        const double d03 = s->square[2][lane];
        const double w1 = corner_weight(s->square[5][lane], d03, d02) * pull.scaled[1] * s->area_term[1][lane];
        const double w2 = corner_weight(s->square[4][lane], d03, d01) * pull.scaled[2] * s->area_term[2][lane];
        const double w3 = corner_weight(s->square[3][lane], d02, d01) * pull.scaled[3] * s->area_term[3][lane];
        const Vec3 g = s->inverse_det[lane] * pull.center;
        store(out, lane,
              pull.center - pull.radial - dot(cross(v, w), g) * (u - r) - dot(cross(w, u), g) * (v - r) -
                  dot(cross(u, v), g) * (w - r) - w1 * load(s->normal[1], lane) - w2 * load(s->normal[2], lane) -
                  w3 * load(s->normal[3], lane));
    }
    if (!cosines)
        return;
    for (int lane = 0; lane < kLanes; ++lane) {
        const EdgePull pull = pull_on_edges(*s, *slope, lane);
        const Vec3 x0 = load(in->corner[0], lane);
        store(out, lane,
              load(out, lane) - (2.0 * pull.on[0]) * (load(in->corner[1], lane) - x0) -
                  (2.0 * pull.on[1]) * (load(in->corner[2], lane) - x0) -
                  (2.0 * pull.on[2]) * (load(in->corner[3], lane) - x0));
    }
}

WCT_MULTIVERSION
void measure_worst(const TetLanes &tets, bool cosines, WorstLanes &worst) {
    const TetLanes *__restrict in = &tets;
    WorstLanes *__restrict out = &worst;
    Lanes square[6];
    for (int lane = 0; lane < kLanes; ++lane) {
        const Core k = core_of(*in, lane);
        const double cube = k.longest * std::sqrt(k.longest);
        out->flatness[lane] = k.det / cube;
        // h_i / R = N_i . m / (|N_i| |m|) with m = 2 det r; over facet 0 with m - 2 det u. det > 0 drops out but there.
        // The least of them has the least signed square, which takes one root for all four.
        const Vec3 m = k.uu * k.a + k.vv * k.b + k.ww * k.c;
        const Vec3 inward = Vec3{} - (k.a + k.b + k.c);
        const double p0 = dot(inward, m - (2.0 * divisor(k, cube)) * k.u);
        const double p1 = dot(k.a, m);
        const double p2 = dot(k.b, m);
        const double p3 = dot(k.c, m);
        const double least =
            smaller(smaller(signed_square(p0) / dot(inward, inward), signed_square(p1) / dot(k.a, k.a)),
                    smaller(signed_square(p2) / dot(k.b, k.b), signed_square(p3) / dot(k.c, k.c)));
        out->height[lane] = signed_root(least / dot(m, m));
        out->cosine[lane] = 1.0;
        square[0][lane] = k.uu;
        square[1][lane] = k.vv;
        square[2][lane] = k.ww;
        square[3][lane] = k.d12;
        square[4][lane] = k.d13;
        square[5][lane] = k.d23;
    }
    if (!cosines)
        return;
    for (int lane = 0; lane < kLanes; ++lane) {
        double inverse[6];
        for (int i = 0; i < 6; ++i)
            inverse[i] = 0.5 / square[i].at[lane];
        double least = 1.0; // of the signed squares of the cosines
#define WCT_LEAST(k, p, q, r)                                                                                          \
    least = smaller(least, signed_square(square[p].at[lane] + square[q].at[lane] - square[r].at[lane]) *               \
                               (inverse[p] * inverse[q]))
        WCT_EACH_ANGLE(WCT_LEAST);
#undef WCT_LEAST
        out->cosine[lane] = signed_root(least);
    }
}

#undef WCT_EACH_ANGLE

} // namespace wct::energy
