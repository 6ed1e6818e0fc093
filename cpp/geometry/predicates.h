#pragma once

#include "base/vec3.h"

namespace wct::geometry {

/// Exact sign of det(b - a, c - a, d - a): 1 for a positive tet, -1 for an inverted one, 0 for four coplanar points.
/// Coordinates must be finite. Floating point decides what its error bound allows, integer arithmetic the rest.
int orient3d(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d);

/// Exact position of e to the sphere through a positive tet a, b, c, d: 1 inside, -1 outside, 0 on it. For an inverted
/// tet the signs are swapped. Coordinates must be finite.
int insphere(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d, const Vec3 &e);

/// Exact: does the positive tet contain its circumcenter strictly inside?
bool contains_circumcenter(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d);

/// Exact: are all three angles of the triangle below 90 degrees?
bool acute(const Vec3 &a, const Vec3 &b, const Vec3 &c);

/// Exact: are all six dihedral angles of the tet, of either orientation, below 90 degrees?
bool dihedral_angles_acute(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d);

/// Does this flatness (det / longest edge^3), as floating point finds it, prove that the tet is positive? The rounding
/// error of det is below 8e-16 times the sum of its absolute terms, which is at most 6 longest^3. Above 1/sqrt(2), the
/// regular tet's, something underflowed.
inline bool surely_positive(double flatness) {
    return flatness > 1e-14 && flatness < 0.75;
}

} // namespace wct::geometry
