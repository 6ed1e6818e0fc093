#include "library/surface_lengths.h"

#include "base/sort_unique.h"
#include "geometry/triangle_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wct::library {

namespace {

constexpr double kQuantile = 0.99;
/// How long edges may be on average, in those of the mesh.
constexpr double kSurfaceEdges = 1.25;
/// Of interfaces, in what the rest may be: so they come out below 1.1.
constexpr double kInterfaces = 0.82;
/// Meshes come out so much coarser than asked for, on average.
constexpr double kCoarser = 1.05;
/// The range up to which lengths are one length but for scatter.
constexpr double kUniform = 1.5;
/// How often lengths are averaged with those at the other ends of edges.
constexpr int kAveraged = 4;

/// Points as their patches see them: a point of two patches is two wedges.
struct Wedges {
    std::vector<Facet> triangles; // of wedges
    std::vector<int> point, patch;

    explicit Wedges(const OwnSurface &surface) {
        std::vector<std::pair<int, int>> all;
        const auto of = [&](std::size_t t, int i) {
            return std::pair(surface.triangles[t][i], surface.strata.patch[t]);
        };
        for (std::size_t t = 0; t < surface.triangles.size(); ++t)
            for (int i = 0; i < 3; ++i)
                all.push_back(of(t, i));
        sort_unique(all);
        for (const auto &[v, p] : all) {
            point.push_back(v);
            patch.push_back(p);
        }
        const auto place = [&](std::size_t t, int i) {
            return static_cast<int>(std::lower_bound(all.begin(), all.end(), of(t, i)) - all.begin());
        };
        for (std::size_t t = 0; t < surface.triangles.size(); ++t)
            triangles.push_back({place(t, 0), place(t, 1), place(t, 2)});
    }
    std::size_t count() const { return point.size(); }
};

/// The value below which this share lies, interpolated.
double quantile(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    const double place = share * static_cast<double>(values.size() - 1);
    const auto low = static_cast<std::size_t>(place), high = std::min(low + 1, values.size() - 1);
    return values[low] + (place - static_cast<double>(low)) * (values[high] - values[low]);
}

/// Per wedge the unit normal of the smooth patch.
std::vector<Vec3> smooth_normals(const OwnSurface &surface, const Wedges &wedges) {
    std::vector<Vec3> normals(wedges.count());
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto &[a, b, c] = surface.triangles[t];
        const std::array<Vec3, 3> at{surface.points[a], surface.points[b], surface.points[c]};
        const Vec3 normal = unit(normal_of(at));
        for (int i = 0; i < 3; ++i)
            normals[wedges.triangles[t][i]] += angle(at[(i + 1) % 3] - at[i], at[(i + 2) % 3] - at[i]) * normal;
    }
    for (Vec3 &normal : normals)
        normal = unit(normal);
    return normals;
}

/// Per wedge the mean logarithm of the lengths of its edges, smoothed.
std::vector<double> mean_logs(const Wedges &wedges, const geometry::TriangleEdges &edges,
                              const std::vector<double> &logs) {
    std::vector<double> sum(wedges.count(), 0.0), degree(wedges.count(), 0.0);
    for (std::size_t e = 0; e < edges.count(); ++e)
        for (const int w : edges.edges()[e]) {
            sum[w] += logs[e];
            degree[w] += 1.0;
        }
    for (std::size_t w = 0; w < sum.size(); ++w)
        sum[w] /= degree[w];
    for (int k = 0; k < kAveraged; ++k) {
        std::vector<double> next = sum;
        for (const auto &[a, b] : edges.edges()) {
            next[a] += sum[b];
            next[b] += sum[a];
        }
        for (std::size_t w = 0; w < next.size(); ++w)
            sum[w] = next[w] / (1.0 + degree[w]);
    }
    return sum;
}

/// Per wedge the length of edges there: one length on patches where it is the same but for scatter.
std::vector<double> own_edges(const OwnSurface &surface, const Wedges &wedges) {
    const geometry::TriangleEdges edges(wedges.triangles);
    const auto at = [&](int w) { return surface.points[wedges.point[w]]; };
    std::vector<double> logs;
    for (const auto &[a, b] : edges.edges())
        logs.push_back(std::log(std::max(norm(at(a) - at(b)), std::numeric_limits<double>::min())));
    std::vector<double> lengths = mean_logs(wedges, edges, logs);
    struct Range {
        double least = std::numeric_limits<double>::infinity(), most = -least, sum = 0.0, count = 0.0;
    };
    std::vector<Range> patches(surface.sides.size());
    for (std::size_t w = 0; w < wedges.count(); ++w) {
        Range &of = patches[wedges.patch[w]];
        of.least = std::min(of.least, lengths[w]);
        of.most = std::max(of.most, lengths[w]);
    }
    for (std::size_t e = 0; e < edges.count(); ++e) {
        Range &of = patches[wedges.patch[edges.edges()[e][0]]];
        of.sum += logs[e];
        of.count += 1.0;
    }
    for (std::size_t w = 0; w < wedges.count(); ++w) {
        const Range &of = patches[wedges.patch[w]];
        lengths[w] = std::exp(of.most - of.least < std::log(kUniform) ? of.sum / of.count : lengths[w]);
    }
    return lengths;
}

} // namespace

double facet_sag(const OwnSurface &surface) {
    const Wedges wedges(surface);
    const std::vector<Vec3> normals = smooth_normals(surface, wedges);
    std::vector<double> sags;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto &[a, b, c] = surface.triangles[t];
        const std::array<Vec3, 3> at{surface.points[a], surface.points[b], surface.points[c]};
        if (norm(normal_of(at)) == 0.0)
            continue;
        double most = 0.0, sum = 0.0;
        for (int i = 0; i < 3; ++i) {
            const int next = (i + 1) % 3;
            const double turn =
                dot(normals[wedges.triangles[t][next]] - normals[wedges.triangles[t][i]], at[next] - at[i]);
            most = std::max(most, std::abs(turn));
            sum += turn;
        }
        sags.push_back(std::max(most / 8.0, std::abs(sum) / 18.0));
    }
    return sags.empty() ? 0.0 : quantile(std::move(sags), kQuantile);
}

std::vector<double> longest_edges(const OwnSurface &surface) {
    const Wedges wedges(surface);
    const std::vector<double> own = own_edges(surface, wedges);
    std::vector<double> out(surface.points.size(), std::numeric_limits<double>::infinity());
    double longest = 0.0;
    for (std::size_t w = 0; w < wedges.count(); ++w) {
        const bool between = surface.sides[wedges.patch[w]][1] >= 0;
        const double length = own[w] * (between ? kInterfaces : 1.0) * (kSurfaceEdges / kCoarser);
        double &least = out[wedges.point[w]];
        least = std::min(least, length);
        longest = std::max(longest, length);
    }
    for (double &one : out)
        one = std::isinf(one) ? longest : one;
    return out;
}

} // namespace wct::library
