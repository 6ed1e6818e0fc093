#include "deviation.h"

#include <algorithm>
#include <cmath>

namespace wct {

namespace {

constexpr int kSamples = 5; // steps along a facet's edge

struct Range {
    double above = 0.0;
    double below = 0.0;
    double missed = 0.0;
};

struct Facets {
    std::vector<std::array<int, 3>> corners;
    std::vector<Range> range;
    BoxTree tree;
    double volume = 0.0; // of all tets
};

Range sample(const std::array<Vec3, 3> &corner, const Reference &reference) {
    Range range;
    for (int j = 0; j <= kSamples; ++j)
        for (int k = 0; k <= kSamples - j; ++k) {
            const double u = static_cast<double>(j) / kSamples;
            const double v = static_cast<double>(k) / kSamples;
            const Vec3 p = corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]);
            const Foot foot = reference.nearest(p);
            const double height = reference.height(p, foot);
            range.above = std::max(range.above, height);
            range.below = std::min(range.below, height);
        }
    return range;
}

Facets measure_facets(const Cloud &cloud, const Complex &complex, const Reference &reference) {
    Facets facets;
    std::vector<Box> boxes;
    for (std::size_t t = 0; t < complex.all.tets.size(); ++t) {
        if (complex.region[t] < 0)
            continue;
        const auto &tet = complex.all.tets[t];
        const Vec3 &o = cloud.points[tet[0]];
        facets.volume += dot(cross(cloud.points[tet[1]] - o, cloud.points[tet[2]] - o), cloud.points[tet[3]] - o) / 6.0;
        for (int i = 0; i < 4; ++i) {
            if (!complex.on_surface(static_cast<int>(t), i))
                continue;
            const auto f = complex.facet(static_cast<int>(t), i);
            const std::array<Vec3, 3> corner{cloud.points[f[0]], cloud.points[f[1]], cloud.points[f[2]]};
            Box box;
            for (const Vec3 &p : corner)
                box.add(p);
            boxes.push_back(box);
            facets.corners.push_back(f);
            facets.range.push_back(sample(corner, reference));
        }
    }
    facets.tree = BoxTree(boxes);
    return facets;
}

/// Distance from p to the facets, and the nearest one.
double nearest_facet(const Cloud &cloud, const Facets &facets, const Vec3 &p, std::size_t &facet) {
    return std::sqrt(facets.tree.minimise(
        std::numeric_limits<double>::infinity(), [&](std::size_t node) { return facets.tree.box(node).square(p); },
        [&](std::size_t item, double best) {
            const auto &f = facets.corners[item];
            const double square =
                nearest_on_triangle(p, cloud.points[f[0]], cloud.points[f[1]], cloud.points[f[2]]).square;
            if (square < best)
                facet = item;
            return square;
        }));
}

/// Volume between the reference's sides that are inside and those that are outside.
double enclosed_volume(const SurfaceData &data) {
    double volume = 0.0;
    const Vec3 &o = data.points[data.triangles[0][0]];
    for (std::size_t t = 0; t < data.triangles.size(); ++t) {
        const auto &[a, b, c] = data.triangles[t];
        const auto &sides = data.sides[data.patch[t]];
        if ((sides[0] < 0) != (sides[1] < 0))
            volume += (sides[0] < 0 ? -1.0 : 1.0) *
                      dot(cross(data.points[a] - o, data.points[b] - o), data.points[c] - o) / 6.0;
    }
    return volume;
}

} // namespace

Deviation measure_deviation(const Cloud &cloud, const Complex &complex, const Reference &reference) {
    const auto &data = reference.data();
    Facets facets = measure_facets(cloud, complex, reference);
    Deviation out;
    std::vector<std::size_t> nearest(data.points.size(), 0);
    std::vector<char> known(data.points.size(), 0);
    for (const auto &[a, b, c] : data.triangles) {
        const Vec3 middle = (1.0 / 3.0) * (data.points[a] + data.points[b] + data.points[c]);
        std::size_t facet = 0;
        double far = nearest_facet(cloud, facets, middle, facet);
        facets.range[facet].missed = std::max(facets.range[facet].missed, far);
        out.most_in = std::max(out.most_in, far);
        for (const int v : {a, b, c}) {
            if (known[v])
                continue;
            known[v] = 1;
            far = nearest_facet(cloud, facets, data.points[v], facet);
            facets.range[facet].missed = std::max(facets.range[facet].missed, far);
            out.most_in = std::max(out.most_in, far);
            nearest[v] = facet;
        }
    }
    std::vector<Range> mean(cloud.count());
    std::vector<double> count(cloud.count(), 0.0);
    for (std::size_t f = 0; f < facets.corners.size(); ++f) {
        const Range &r = facets.range[f];
        out.most_out = std::max({out.most_out, r.above, -r.below});
        for (const int v : facets.corners[f]) {
            mean[v].above += r.above;
            mean[v].below += r.below;
            mean[v].missed += r.missed;
            count[v] += 1.0;
        }
    }
    out.above.assign(data.points.size(), 0.0);
    out.below.assign(data.points.size(), 0.0);
    out.missed.assign(data.points.size(), 0.0);
    for (std::size_t v = 0; v < data.points.size(); ++v) {
        if (!known[v])
            continue;
        for (const int w : facets.corners[nearest[v]]) {
            out.above[v] = std::max(out.above[v], mean[w].above / count[w]);
            out.below[v] = std::min(out.below[v], mean[w].below / count[w]);
            out.missed[v] = std::max(out.missed[v], mean[w].missed / count[w]);
        }
    }
    const double enclosed = enclosed_volume(data);
    out.volume_gain = enclosed > 0.0 ? facets.volume / enclosed - 1.0 : 0.0;
    return out;
}

} // namespace wct
