#pragma once

#include "base/cells.h"
#include "base/vec3.h"
#include "domain/reference.h"
#include "domain/region_map.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace wct::tests {

/// A mesh in strata: what a search starts from and, as its own surface, what it stays near.
struct Body {
    std::vector<Vec3> points;
    std::vector<Tet> tets;
    std::vector<int> regions;
    std::vector<Facet> facets; // outward, or out of the region with the smaller number
    std::vector<int> patch;
    std::vector<std::array<int, 2>> sides; // per patch: the region behind and the one before, -1 outside
    std::vector<Edge> creases;
    std::vector<int> curve;
    std::vector<int> corners;
    std::vector<Stratum> stratum;
    std::vector<int> label;
    double size = 0.0; // of its edges, about

    domain::SurfaceData surface() const;
    domain::InputMesh mesh() const { return {points, tets, regions}; }
};

/// What tells apart the smooth faces of a body: one number per face, from the outward normal and middle of a facet.
using FaceOf = std::function<int(const Vec3 &middle, const Vec3 &normal)>;

/// Facets between different regions or to the outside, cut into patches by face and sides; creases where patches meet,
/// corners where creases of different patches do.
Body stratified(std::vector<Vec3> points, std::vector<Tet> tets, std::vector<int> regions, const FaceOf &face_of);

/// The unit cube of n cubes along each axis, each cut into six tets; vertices are off the lattice by at most `jitter`
/// of its cells, each within its stratum. Tets left of the plane x = `split` are region 0, the others region 1: the
/// plane must be one of the lattice's.
Body cube(int n, double jitter, std::uint64_t seed, double split = 2.0);
/// The same, pulled onto the unit ball: one curved patch.
Body ball(int n, double jitter, std::uint64_t seed);
/// The ball in an upper and a lower patch: the crease between them runs along edges, not smoothly.
Body cut_ball(int n, double jitter, std::uint64_t seed);
/// Radius and height 1: a curved patch, two planes, two round creases.
Body cylinder(int n, double jitter, std::uint64_t seed);
/// The cylinder in two regions, cut at half its height (n is even): there is a rim on its smooth side.
Body drum(int n);

/// Faces along the z axis by where they look, to within a few degrees.
int facing(const Vec3 &middle, const Vec3 &normal);
/// Regions round the z axis, as high and as far out as so many parts: from each turn (degrees, ascending) to the next
/// there is the region of that turn, and none where that is negative.
struct Turn {
    double from;
    int region;
};
Body round_axis(const std::vector<Turn> &turns, int parts);

/// Volume of all tets of each region.
std::vector<double> volumes(const Body &body);

} // namespace wct::tests
