#include "measure/circumcentric_dual.h"

#include "measure/shape_lanes.h"

#include <limits>

namespace wct::measure {

namespace {

constexpr double kEps = 0x1p-53;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Roundings that the terms of a P_i pass through, of a cotangent over 1 + its square, of the divisors.
constexpr double kHeightBound = 24.0 * kEps;
constexpr double kCotangentBound = 16.0 * kEps;
constexpr double kDivisorBound = 10.0 * kEps;
/// What underflow may take.
constexpr double kFloor = 1e-300;
constexpr std::size_t kChunk = 4096;

/// The edge of facet i, as kOutward has it, opposite its corner k, at 3 i + k.
constexpr std::array<int, 12> opposite_edges() {
    std::array<int, 12> out{};
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 3; ++k)
            for (int e = 0; e < 6; ++e) {
                const int a = kOutward[i][(k + 1) % 3];
                const int b = kOutward[i][(k + 2) % 3];
                if ((kEdges[e][0] == a && kEdges[e][1] == b) || (kEdges[e][0] == b && kEdges[e][1] == a))
                    out[3 * i + k] = e;
            }
    return out;
}
constexpr std::array<int, 12> kOpposite = opposite_edges();

/// Row b: where the angle of facet i at its corner k is after the renumbering i -> i xor b.
constexpr std::array<std::array<int, 12>, 4> angle_columns() {
    std::array<std::array<int, 12>, 4> out{};
    for (int b = 0; b < 4; ++b)
        for (int i = 0; i < 4; ++i)
            for (int k = 0; k < 3; ++k)
                for (int j = 0; j < 3; ++j)
                    if (kOutward[i ^ b][j] == (kOutward[i][k] ^ b))
                        out[b][3 * i + k] = 3 * (i ^ b) + j;
    return out;
}
constexpr std::array<std::array<int, 12>, 4> kAngleColumns = angle_columns();

/// Of each tet, in the renumbered order.
struct DualLanes {
    alignas(64) Lanes height[4];
    Lanes error[4];
    Lanes cotangent[12];
    Lanes square[6];
    std::array<std::int32_t, kLanes> base;
};

WCT_INLINE Vec3 absolute(const Vec3 &a) {
    return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)};
}
/// A cross product with every term replaced by its absolute value.
WCT_INLINE Vec3 cross_size(const Vec3 &a, const Vec3 &b) {
    return {a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x};
}

WCT_MULTIVERSION void dual_of(const CornerLanes &x, DualLanes &out) {
    for (int l = 0; l < kLanes; ++l) {
        const Shape s(x.corner(0, l), x.corner(1, l), x.corner(2, l), x.corner(3, l));
        const Vec3 u = absolute(s.u);
        const Vec3 v = absolute(s.v);
        const Vec3 w = absolute(s.w);
        const Vec3 m1 = cross_size(v, w);
        const Vec3 m2 = cross_size(w, u);
        const Vec3 m3 = cross_size(u, v);
        const Vec3 m0 = m1 + m2 + m3;
        const double det = std::fabs(s.det);
        const double det_size = dot(u, m1);
        const double det_error = kDivisorBound * det_size / det;
        const Vec3 q = s.s01 * m1 + s.s02 * m2 + s.s03 * m3;
        const auto facet = [&](int i, double p, double area, const Vec3 &m, double size) {
            const double height = p / (2.0 * det * area);
            const double relative = det_error + kDivisorBound * std::sqrt(Shape::square(m)) / area;
            const double error = (kHeightBound * size + kFloor) / (2.0 * det * area) + std::fabs(height) * relative;
            out.height[i][l] = height;
            out.error[i][l] = relative < 0.25 ? 2.0 * error : kInfinity; // else the divisor itself is in doubt
        };
        facet(0, s.p0, s.a0, m0, dot(m0, q) + 2.0 * det_size * det_size);
        facet(1, s.p1, s.a1, m1, dot(m1, q));
        facet(2, s.p2, s.a2, m2, dot(m2, q));
        facet(3, s.p3, s.a3, m3, dot(m3, q));
        each_face_dot(s, [&](int k, double area, double value) { out.cotangent[k][l] = value / area; });
        out.square[0][l] = s.s01;
        out.square[1][l] = s.s02;
        out.square[2][l] = s.s03;
        out.square[3][l] = s.s12;
        out.square[4][l] = s.s13;
        out.square[5][l] = s.s23;
        out.base[l] = s.base;
    }
}

/// Calls take(tet, lanes, lane) for each of these tets.
template <class Take>
void each_dual(const UnitCube &cube, const std::vector<Tet> &tets, std::size_t begin, std::size_t end,
               const Take &take) {
    DualLanes found;
    for (std::size_t first = begin; first < end; first += kLanes) {
        dual_of(CornerLanes(cube.points, tets, first), found);
        for (std::size_t t = first; t < std::min(end, first + kLanes); ++t)
            take(t, found, static_cast<int>(t - first));
    }
}

/// Facet i's height and error of a tet, in its own order, in the unit of the points.
std::array<double, 2> height_of(const DualLanes &found, int lane, int i, int exponent) {
    const int row = i ^ found.base[lane];
    return {std::ldexp(found.height[row][lane], exponent), std::ldexp(found.error[row][lane], exponent)};
}

} // namespace

void heights(const std::vector<Vec3> &points, const std::vector<Tet> &tets, std::span<double> values,
             std::span<double> errors, const Workers &workers) {
    const UnitCube cube(points);
    workers.for_chunks(tets.size(), kChunk, [&](std::size_t begin, std::size_t end) {
        each_dual(cube, tets, begin, end, [&](std::size_t t, const DualLanes &found, int lane) {
            for (int i = 0; i < 4; ++i) {
                const auto [height, error] = height_of(found, lane, i, cube.exponent);
                values[4 * t + i] = height;
                errors[4 * t + i] = error;
            }
        });
    });
}

void edge_sums(const std::vector<Vec3> &points, const std::vector<Tet> &tets, const std::vector<TetEdges> &tet_edges,
               std::span<const double> coefficient, std::span<double> values, std::span<double> errors,
               std::span<double> sums, std::span<double> doubts, const Workers &workers) {
    const UnitCube cube(points);
    struct Part {
        std::array<double, 6> sum{}, doubt{};
    };
    std::fill(sums.begin(), sums.end(), 0.0);
    std::fill(doubts.begin(), doubts.end(), 0.0);
    workers.in_order<std::vector<Part>>(
        tets.size(), kChunk,
        [&](std::size_t begin, std::size_t end, std::vector<Part> &parts) {
            parts.assign(end - begin, {});
            each_dual(cube, tets, begin, end, [&](std::size_t t, const DualLanes &found, int lane) {
                Part &part = parts[t - begin];
                const std::array<int, 12> &columns = kAngleColumns[found.base[lane]];
                for (int i = 0; i < 4; ++i) {
                    auto [height, error] = height_of(found, lane, i, cube.exponent);
                    if (!coefficient.empty()) {
                        height *= coefficient[t];
                        error *= std::fabs(coefficient[t]);
                    }
                    values[4 * t + i] = height;
                    errors[4 * t + i] = error;
                    for (int k = 3 * i; k < 3 * i + 3; ++k) {
                        const double cotangent = found.cotangent[columns[k]][lane];
                        part.sum[kOpposite[k]] += cotangent * height;
                        part.doubt[kOpposite[k]] += std::fabs(cotangent) * error +
                                                    kCotangentBound * (1.0 + cotangent * cotangent) * std::fabs(height);
                    }
                }
                for (double &doubt : part.doubt)
                    doubt = std::isnan(doubt) ? kInfinity : doubt;
            });
        },
        [&](std::size_t begin, std::size_t end, const std::vector<Part> &parts) {
            for (std::size_t t = begin; t < end; ++t)
                for (int e = 0; e < 6; ++e) {
                    sums[tet_edges[t][e]] += parts[t - begin].sum[e];
                    doubts[tet_edges[t][e]] += parts[t - begin].doubt[e];
                }
        });
}

void unsigned_volumes(const std::vector<Vec3> &points, const std::vector<Tet> &tets, std::span<double> out,
                      const Workers &workers) {
    const UnitCube cube(points);
    workers.for_chunks(tets.size(), kChunk, [&](std::size_t begin, std::size_t end) {
        each_dual(cube, tets, begin, end, [&](std::size_t t, const DualLanes &found, int lane) {
            double sum = 0.0;
            for (int k = 0; k < 12; ++k)
                sum += std::fabs(found.height[k / 3][lane] * found.cotangent[k][lane] *
                                 found.square[kOpposite[k]][lane] / 12.0);
            out[t] = std::isnan(sum) ? kInfinity : std::ldexp(sum, 3 * cube.exponent);
        });
    });
}

void orthogonality(const std::vector<Vec3> &points, const std::vector<Tet> &tets,
                   const std::vector<std::array<std::int32_t, 4>> &pairs, std::span<double> out,
                   const Workers &workers) {
    const UnitCube cube(points);
    const auto four_centroids = [&](const Tet &tet) {
        return cube.points[tet[0]] + cube.points[tet[1]] + cube.points[tet[2]] + cube.points[tet[3]];
    };
    workers.for_each(pairs.size(), kChunk, [&](std::size_t p) {
        const auto &[tet, facet, across, other] = pairs[p];
        const Facet corners = outward_facet(tets[tet], facet);
        const Vec3 normal = normal_of({cube.points[corners[0]], cube.points[corners[1]], cube.points[corners[2]]});
        const Vec3 line = four_centroids(tets[across]) - four_centroids(tets[tet]);
        out[p] = dot(normal, line) / (norm(normal) * norm(line));
    });
}

} // namespace wct::measure
