#include "domain/local_tolerance.h"

#include "domain/limit_gradient.h"
#include "domain/sharp_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wct::domain {

namespace {

/// Least distance of what a ray hits from where it starts, in diagonals of the surface: not the triangle it starts on.
constexpr double kStart = 1e-9;
constexpr double kShare = 0.1;      // of the wall, the gap or the radius
constexpr double kGrade = 0.1;      // growth per distance along the surface
constexpr double kParallel = -0.88; // cosine between the normals of two sides: within 28 degrees
/// Where a facet is measured: in the middle, and half-way from there to the corners.
constexpr double kSamples[4][3] = {
    {1. / 3, 1. / 3, 1. / 3}, {.666, .167, .167}, {.167, .666, .167}, {.167, .167, .666}};

/// Whether two sides so far apart at p meet at a sharp edge near there.
bool meets(const SharpEdges &edges, const Vec3 &p, double width) {
    constexpr double slack = 1.5;
    constexpr double narrowest = 0.05; // 2 sin of half of 3 degrees
    if (edges.empty())
        return false;
    const SharpFoot foot = edges.nearest(p, slack * width / narrowest);
    return foot.edge >= 0 && slack * width > edges.narrow(foot.edge) * foot.distance;
}

} // namespace

std::vector<double> local_tolerance(const Reference &reference, double most, double floor, const Workers &workers) {
    const SurfaceData &data = reference.data();
    const SharpEdges sharp(reference), notches(reference, true);
    const double reach = 2.0 * most / kShare; // of a wall or gap that counts, or of twice the radius
    std::vector<double> of_triangle(data.triangles.size(), most);
    workers.for_each(of_triangle.size(), 64, [&](std::size_t t) {
        const int triangle = static_cast<int>(t);
        const Vec3 &n = reference.normal(triangle);
        if (n == Vec3{})
            return;
        const auto &[a, b, c] = data.triangles[t];
        double bend = 0.0;
        for (int k = 0; k < 3 && !reference.planar(data.patch[t]); ++k)
            bend = std::max(bend, std::fabs(reference.curvature(reference.wedge(triangle, k))[0]));
        for (int side = 0; side < 2; ++side)
            for (const auto &w : kSamples) {
                const Vec3 p = w[0] * data.points[a] + w[1] * data.points[b] + w[2] * data.points[c];
                const Vec3 along = (side == 0 ? -1.0 : 1.0) * n;
                int hit = -1;
                const double across = reference.ray(p, along, kStart * reference.diagonal(), reach, hit);
                if (hit < 0 || dot(reference.normal(hit), n) > kParallel)
                    continue;
                // Round a hole or a rod the way across is twice the radius.
                const double wide = bend > 0.0 ? std::min(across, std::max(0.5 * across, 1.0 / bend)) : across;
                const bool outside = data.sides[data.patch[t]][side] < 0;
                if (kShare * wide < of_triangle[t] && !meets(outside ? notches : sharp, p, across))
                    of_triangle[t] = kShare * wide;
            }
    });
    std::vector<double> at(data.points.size(), most);
    for (std::size_t t = 0; t < of_triangle.size(); ++t)
        for (const int v : data.triangles[t])
            at[v] = std::min(at[v], std::max(of_triangle[t], std::min(floor, most)));
    limit_gradient(at, data.points, neighbours(data.triangles, data.points.size()), kGrade);
    return at;
}

} // namespace wct::domain
