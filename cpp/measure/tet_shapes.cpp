#include "measure/tet_shapes.h"

#include "base/lane_extremes.h"
#include "geometry/predicates.h"
#include "measure/shape_lanes.h"

#include <limits>
#include <numbers>

namespace wct::measure {

namespace {

constexpr double kEps = 0x1p-53;
/// With L the longest edge, all terms of a P_i add up to at most 44 L^6, of an N_i . N_j to 12 L^4 and of the dot
/// product of two edges to L^2; times the roundings they pass through (24, 15 and 6) these bound the error of their
/// signs. What they leave open, one tet in millions, integers decide. The last is what underflow may take.
constexpr double kHeightBound = 44.0 * 24.0 * kEps;
constexpr double kDihedralBound = 12.0 * 15.0 * kEps;
constexpr double kAngleBound = 6.0 * kEps;
constexpr double kFloor = 1e-300;
/// Tets per chunk of a loop that threads share.
constexpr std::size_t kChunk = 4096;

/// What the lanes of `measure` give. Cotangents fall as angles grow; the least, over its bound, says how sure a flag
/// is.
struct QualityLanes {
    alignas(64) Lanes height[4];
    Lanes most_height;
    Lanes least_face, most_face;         // cotangents
    Lanes least_dihedral, most_dihedral; // cotangents
    Lanes ratio, volume;
    Lanes sure[3];   // the least of P_i, of the face dots and of the dihedral dots, over their bound
    Lanes undefined; // not 0 where an angle is no number
    std::array<std::int32_t, kLanes> base;
};

/// Some angles of a tet, each given by its cosine and sine times a positive factor of its own.
struct Angles {
    double least = std::numeric_limits<double>::infinity(); // cotangent
    double most = -std::numeric_limits<double>::infinity(); // cotangent
    double least_dot = std::numeric_limits<double>::infinity();
    double odd = 0.0; // else where a cotangent is infinite or no number

    WCT_INLINE void add(double dot, double sine) {
        const double cotangent = dot / sine;
        least = smaller(least, cotangent);
        most = larger(most, cotangent);
        least_dot = smaller(least_dot, dot);
        odd += cotangent * 0.0;
    }
};

WCT_MULTIVERSION void quality_of(const CornerLanes &x, QualityLanes &out) {
    for (int l = 0; l < kLanes; ++l) {
        const Shape s(x.corner(0, l), x.corner(1, l), x.corner(2, l), x.corner(3, l));
        const double size = std::sqrt(Shape::square(s.q));
        out.height[0][l] = s.p0 / (s.a0 * size);
        out.height[1][l] = s.p1 / (s.a1 * size);
        out.height[2][l] = s.p2 / (s.a2 * size);
        out.height[3][l] = s.p3 / (s.a3 * size);
        const double longest = larger(larger(larger(s.s01, s.s02), larger(s.s03, s.s12)), larger(s.s13, s.s23));
        const double shortest = smaller(smaller(smaller(s.s01, s.s02), smaller(s.s03, s.s12)), smaller(s.s13, s.s23));
        Angles faces;
        each_face_dot(s, [&](int, double area, double value) { faces.add(value, area); });
        Angles dihedrals;
        const double det = std::fabs(s.det);
        each_dihedral_dot(s, [&](int, double square, double value) { dihedrals.add(value, det * std::sqrt(square)); });
        out.least_face[l] = faces.least;
        out.most_face[l] = faces.most;
        out.least_dihedral[l] = dihedrals.least;
        out.most_dihedral[l] = dihedrals.most;
        out.sure[1][l] = faces.least_dot / (kAngleBound * longest + kFloor);
        out.sure[2][l] = dihedrals.least_dot / (kDihedralBound * longest * longest + kFloor);
        out.sure[0][l] =
            smaller(smaller(s.p0, s.p1), smaller(s.p2, s.p3)) / (kHeightBound * longest * longest * longest + kFloor);
        out.undefined[l] = faces.odd + dihedrals.odd;
        out.ratio[l] = s.radius() / std::sqrt(shortest);
        out.volume[l] = s.det / 6.0;
        out.base[l] = s.base;
    }
}

/// The least and the greatest, as NumPy has them: what is no number is both.
template <std::size_t count> std::array<double, 2> extremes(const std::array<double, count> &values) {
    double low = values[0];
    double high = values[0];
    for (const double value : values) {
        low = std::isnan(low) || low <= value ? low : value;
        high = std::isnan(high) || high >= value ? high : value;
    }
    return {low, high};
}

/// Lane `l` of the extremes anew, where some cotangents are infinite or no numbers.
void undefined_extremes(const CornerLanes &x, int l, QualityLanes &out) {
    const Shape s(x.corner(0, l), x.corner(1, l), x.corner(2, l), x.corner(3, l));
    std::array<double, 12> faces{};
    std::array<double, 6> dihedrals{};
    each_face_dot(s, [&](int k, double area, double value) { faces[k] = value / area; });
    each_dihedral_dot(
        s, [&](int k, double square, double value) { dihedrals[k] = value / (std::fabs(s.det) * std::sqrt(square)); });
    const auto [least_face, most_face] = extremes(faces);
    const auto [least_dihedral, most_dihedral] = extremes(dihedrals);
    out.least_face[l] = least_face;
    out.most_face[l] = most_face;
    out.least_dihedral[l] = least_dihedral;
    out.most_dihedral[l] = most_dihedral;
}

/// Degrees of an angle in (0, 180).
double degrees(double cotangent) {
    return std::atan2(1.0, cotangent) * (180.0 / std::numbers::pi);
}

/// Whether all of its three angles are acute, of every facet.
bool facets_acute(const std::array<Vec3, 4> &x) {
    for (const auto &facet : kFacets)
        if (!geometry::acute(x[facet[0]], x[facet[1]], x[facet[2]]))
            return false;
    return true;
}

} // namespace

void measure(const std::vector<Vec3> &points, const std::vector<Tet> &tets, const QualityRows &out,
             const Workers &workers) {
    const UnitCube cube(points);
    workers.for_chunks(tets.size(), kChunk, [&](std::size_t begin, std::size_t end) {
        QualityLanes found;
        for (std::size_t first = begin; first < end; first += kLanes) {
            const CornerLanes corners(cube.points, tets, first);
            quality_of(corners, found);
            for (std::size_t t = first; t < std::min(end, first + kLanes); ++t) {
                const int l = static_cast<int>(t - first);
                if (found.undefined[l] != 0.0)
                    undefined_extremes(corners, l, found);
                int worst = 0;
                double most = found.height[0][l];
                for (int i = 1; i < 4; ++i) {
                    // As NumPy has it: what is no number is the least, and the greatest.
                    const double h = found.height[i][l];
                    if (h < found.height[worst][l] || (std::isnan(h) && !std::isnan(found.height[worst][l])))
                        worst = i;
                    most = std::isnan(most) || most >= h ? most : h;
                }
                out.min_height[t] = found.height[worst][l];
                out.max_height[t] = most;
                out.worst_facet[t] = static_cast<std::int8_t>(worst ^ found.base[l]);
                out.min_face_angle[t] = degrees(found.most_face[l]);
                out.max_face_angle[t] = degrees(found.least_face[l]);
                out.min_dihedral_angle[t] = degrees(found.most_dihedral[l]);
                out.max_dihedral_angle[t] = degrees(found.least_dihedral[l]);
                out.radius_over_edge[t] = found.ratio[l];
                out.volume[t] = std::ldexp(found.volume[l], 3 * cube.exponent);
                const Tet &tet = tets[t];
                const std::array<Vec3, 4> x = {points[tet[0]], points[tet[1]], points[tet[2]], points[tet[3]]};
                const auto holds = [&](int which, const auto &exactly) {
                    const double sure = found.sure[which][l];
                    return sure > 1.0 || (!(sure < -1.0) && exactly());
                };
                out.well_centered_3[t] =
                    holds(0, [&] { return geometry::contains_circumcenter(x[0], x[1], x[2], x[3]); });
                out.well_centered_2[t] = holds(1, [&] { return facets_acute(x); });
                // Acute implies 2WC, so that only what is 2WC need be looked at.
                out.acute[t] = out.well_centered_2[t] &&
                               holds(2, [&] { return geometry::dihedral_angles_acute(x[0], x[1], x[2], x[3]); });
            }
        }
    });
}

namespace {

struct Single {
    alignas(64) Lanes volume;
    Lanes radius;
};

WCT_MULTIVERSION void single_of(const CornerLanes &x, Single &out) {
    for (int l = 0; l < kLanes; ++l) {
        const Shape s(x.corner(0, l), x.corner(1, l), x.corner(2, l), x.corner(3, l));
        out.volume[l] = s.det / 6.0;
        out.radius[l] = s.radius();
    }
}

/// One number per tet: `of` takes it from the lanes, in the unit of the cube to the power of `dimension`.
template <class Of>
void one_per_tet(const std::vector<Vec3> &points, const std::vector<Tet> &tets, std::span<double> out, int dimension,
                 const Workers &workers, const Of &of) {
    const UnitCube cube(points);
    workers.for_chunks(tets.size(), kChunk, [&](std::size_t begin, std::size_t end) {
        Single found;
        for (std::size_t first = begin; first < end; first += kLanes) {
            single_of(CornerLanes(cube.points, tets, first), found);
            for (std::size_t t = first; t < std::min(end, first + kLanes); ++t)
                out[t] = std::ldexp(of(found)[t - first], dimension * cube.exponent);
        }
    });
}

struct AngleLanes {
    alignas(64) Lanes sine[6];
    Lanes cosine[6];
};

WCT_MULTIVERSION void dihedral_angles_of(const CornerLanes &x, AngleLanes &out) {
    for (int l = 0; l < kLanes; ++l) {
        const Shape s(x.corner(0, l), x.corner(1, l), x.corner(2, l), x.corner(3, l));
        const double det = std::fabs(s.det);
        each_dihedral_dot(s, [&](int k, double square, double value) {
            out.sine[k][l] = det * std::sqrt(square);
            out.cosine[k][l] = value;
        });
    }
}

} // namespace

void volumes(const std::vector<Vec3> &points, const std::vector<Tet> &tets, std::span<double> out,
             const Workers &workers) {
    one_per_tet(points, tets, out, 3, workers, [](const Single &found) -> const Lanes & { return found.volume; });
}

void circumradii(const std::vector<Vec3> &points, const std::vector<Tet> &tets, std::span<double> out,
                 const Workers &workers) {
    one_per_tet(points, tets, out, 1, workers, [](const Single &found) -> const Lanes & { return found.radius; });
}

std::vector<std::int64_t> dihedral_counts(const std::vector<Vec3> &points, const std::vector<Tet> &tets,
                                          std::span<const double> bins, const Workers &workers) {
    const UnitCube cube(points);
    std::vector<std::int64_t> out(bins.size() - 1);
    workers.in_order<std::vector<std::int64_t>>(
        tets.size(), kChunk,
        [&](std::size_t begin, std::size_t end, std::vector<std::int64_t> &counts) {
            counts.assign(out.size(), 0);
            AngleLanes found;
            for (std::size_t first = begin; first < end; first += kLanes) {
                dihedral_angles_of(CornerLanes(cube.points, tets, first), found);
                for (std::size_t l = 0; l < std::min(end - first, std::size_t{kLanes}); ++l)
                    for (int k = 0; k < 6; ++k) {
                        const double angle =
                            std::atan2(found.sine[k][l], found.cosine[k][l]) * (180.0 / std::numbers::pi);
                        const auto bin = std::upper_bound(bins.begin(), bins.end(), angle) - bins.begin() - 1;
                        ++counts[std::clamp<std::ptrdiff_t>(bin, 0, static_cast<std::ptrdiff_t>(counts.size()) - 1)];
                    }
            }
        },
        [&](std::size_t, std::size_t, const std::vector<std::int64_t> &counts) {
            for (std::size_t k = 0; k < out.size(); ++k)
                out[k] += counts[k];
        });
    return out;
}

} // namespace wct::measure
