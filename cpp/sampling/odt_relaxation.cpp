#include "sampling/odt_relaxation.h"

#include "geometry/circumspheres.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace wct::sampling {

namespace {

/// The patch both points belong to, -1 if there is none or, for two crease points, more than one.
int common_patch(const Cloud &cloud, const domain::Reference &reference, const Edge &edge) {
    const std::vector<int> shared = shared_patches(cloud, reference, edge);
    return shared.size() == 1 ? shared.front() : -1;
}

struct Mean {
    Vec3 sum;
    double weight = 0.0;
    void add(const Vec3 &p, double w) {
        sum += w * p;
        weight += w;
    }
};

/// Per point where its neighbourhood wants it: of interior points by the tets round it, of others by the facets.
struct Wishes {
    std::vector<Mean> inner, outer;
};

/// The circumcenter of a tet, drawn in to the centroid where it is far outside: there it says little.
Vec3 drawn_in_circumcenter(const Vec3 &p, const Vec3 &u, const Vec3 &v, const Vec3 &w, double det) {
    constexpr double flat = 1e-9;    // six times the volume, per cube of the mean edge
    constexpr double farthest = 0.5; // of a circumcenter from the centroid, in mean edges
    const Vec3 middle = p + 0.25 * (u + v + w);
    const double edge = (norm(u) + norm(v) + norm(w) + norm(v - u) + norm(w - v) + norm(u - w)) / 6.0;
    if (!(det > flat * edge * edge * edge))
        return middle;
    const Vec3 center = p + geometry::to_circumcenter(u, v, w, det);
    const Vec3 d = center - middle;
    const double far = norm(d);
    return far > farthest * edge ? middle + (farthest * edge / far) * d : center;
}

/// What some tets and their facets on the surface wish of their corners.
struct Part {
    struct OfTet {
        Vec3 center;
        double weight; // negative: none
    };
    struct OfFacet {
        Facet corners;
        Vec3 center;
        double weight;
    };
    std::vector<OfTet> tets;
    std::vector<OfFacet> facets;
};

Part::OfTet wish_of_tet(const Cloud &cloud, const Tet &tet) {
    const Vec3 &p = cloud.points[tet[0]];
    const Vec3 u = cloud.points[tet[1]] - p;
    const Vec3 v = cloud.points[tet[2]] - p;
    const Vec3 w = cloud.points[tet[3]] - p;
    const double det = dot(cross(u, v), w);
    double size = 0.0;
    for (const int k : tet)
        size += 0.25 * cloud.size[k];
    return {drawn_in_circumcenter(p, u, v, w, det), std::fabs(det) / (size * size)};
}

Part::OfFacet wish_of_facet(const Cloud &cloud, const Facet &f) {
    const auto &points = cloud.points;
    const Vec3 n = cross(points[f[1]] - points[f[0]], points[f[2]] - points[f[0]]);
    const double s = (cloud.size[f[0]] + cloud.size[f[1]] + cloud.size[f[2]]) / 3.0;
    return {f, (1.0 / 3.0) * (points[f[0]] + points[f[1]] + points[f[2]]), norm(n) / (s * s)};
}

Wishes wishes_of(const Cloud &cloud, const RestrictedDelaunay &complex, const Workers &workers) {
    constexpr std::size_t chunk = 2048;
    Wishes out{std::vector<Mean>(cloud.count()), std::vector<Mean>(cloud.count())};
    workers.in_order<Part>(
        complex.all.tets.size(), chunk,
        [&](std::size_t begin, std::size_t end, Part &part) {
            part.tets.clear();
            part.facets.clear();
            for (std::size_t t = begin; t < end; ++t) {
                const bool inside = complex.region[t] >= 0;
                part.tets.push_back(inside ? wish_of_tet(cloud, complex.all.tets[t]) : Part::OfTet{{}, -1.0});
                for (int i = 0; inside && i < 4; ++i)
                    if (complex.on_surface(static_cast<int>(t), i))
                        part.facets.push_back(wish_of_facet(cloud, complex.facet(static_cast<int>(t), i)));
            }
        },
        [&](std::size_t begin, std::size_t end, const Part &part) {
            for (std::size_t t = begin; t < end; ++t)
                if (const auto &[center, weight] = part.tets[t - begin]; !(weight < 0.0))
                    for (const int k : complex.all.tets[t])
                        out.inner[k].add(center, weight);
            for (const auto &[corners, center, weight] : part.facets)
                for (const int k : corners)
                    out.outer[k].add(center, weight);
        });
    return out;
}

/// How far the points of a stratum moved last, in sizes: root of the mean square.
double moved(const Cloud &cloud, Stratum role) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < cloud.count(); ++i)
        if (cloud.role[i] == role) {
            const Vec3 move = (1.0 / cloud.size[i]) * cloud.drift[i];
            sum += dot(move, move);
            ++count;
        }
    return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
}

} // namespace

double relax(Cloud &cloud, const domain::Reference &reference, const RestrictedDelaunay &complex, double step,
             double momentum, const Workers &workers) {
    const auto &points = cloud.points;
    const Wishes wishes = wishes_of(cloud, complex, workers);
    const std::vector<Vec3> before = points;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Mean &mean = cloud.role[i] == Stratum::interior ? wishes.inner[i] : wishes.outer[i];
        const bool free =
            cloud.held[i] == Hold::none && (cloud.role[i] == Stratum::interior || cloud.role[i] == Stratum::patch);
        if (free && mean.weight > 0.0)
            cloud.points[i] += step * ((1.0 / mean.weight) * mean.sum - cloud.points[i]);
        if (free && cloud.role[i] == Stratum::interior)
            cloud.points[i] += momentum * cloud.drift[i];
    }
    retract(cloud, reference, workers);
    for (std::size_t i = 0; i < points.size(); ++i)
        cloud.drift[i] = points[i] - before[i];
    return std::max(moved(cloud, Stratum::interior), moved(cloud, Stratum::patch));
}

int mend(Cloud &cloud, const domain::Reference &reference, const RestrictedDelaunay &complex, double longest,
         double shortest) {
    constexpr double dividing = 0.7; // what of the shortest length an edge may have that divides an angle at a corner
    constexpr double apart = 0.5;    // of new points from others, in sizes
    std::vector<std::pair<double, Edge>> far;
    std::vector<std::pair<double, Edge>> near;
    const auto edges = surface_edges(complex);
    std::vector<char> divides(cloud.count(), 0); // the angle of a patch at a corner; it takes a shorter edge to do so
    for (const auto &[v, w] : edges)
        if (cloud.role[v] == Stratum::corner || cloud.role[w] == Stratum::corner)
            divides[v] = divides[w] = 1;
    for (const auto &edge : edges) {
        const auto &[v, w] = edge;
        const double length = norm(cloud.points[v] - cloud.points[w]) / (0.5 * (cloud.size[v] + cloud.size[w]));
        if (length > longest)
            far.emplace_back(-length, edge);
        else if (length < (divides[v] && divides[w] ? dividing : 1.0) * shortest &&
                 (cloud.role[v] == Stratum::patch || cloud.role[w] == Stratum::patch))
            near.emplace_back(length, edge);
    }
    PointGrid grid = surface_grid(cloud, apart);
    int changes = 0;
    std::vector<char> keep(cloud.count(), 1);
    std::vector<char> touched(cloud.count(), 0);
    std::sort(near.begin(), near.end());
    for (const auto &[length, edge] : near) {
        const auto &[v, w] = edge;
        const bool given = cloud.held[w] == Hold::given && cloud.role[v] == Stratum::patch;
        const int goes = cloud.role[w] == Stratum::patch && !given ? w : v;
        if (touched[v] || touched[w] || cloud.held[goes] == Hold::relaxation || cloud.held[goes] >= Hold::all)
            continue;
        touched[v] = touched[w] = 1;
        keep[goes] = 0;
        ++changes;
    }
    std::sort(far.begin(), far.end());
    for (const auto &[length, edge] : far) {
        const auto &[v, w] = edge;
        const int patch = common_patch(cloud, reference, edge);
        const bool held = cloud.held[v] >= Hold::all && cloud.held[w] >= Hold::all;
        if (touched[v] || touched[w] || held || patch < 0)
            continue;
        Vec3 middle = 0.5 * (cloud.points[v] + cloud.points[w]);
        reference.to_patch(middle, reference.nearest(middle, patch, cloud.near[v]));
        const double size = 0.5 * (cloud.size[v] + cloud.size[w]);
        if (grid.crowded(middle, 0.5 * size))
            continue; // the edge is long because the surface is wrong here, not for want of points
        grid.add(middle, 0.5 * size);
        touched[v] = touched[w] = 1;
        cloud.add(middle, Stratum::patch, patch, size);
        keep.push_back(1);
        ++changes;
    }
    cloud.keep(keep);
    return changes;
}

} // namespace wct::sampling
