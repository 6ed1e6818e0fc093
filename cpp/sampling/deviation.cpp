#include "sampling/deviation.h"

#include "geometry/triangle_tree.h"

#include <algorithm>
#include <cmath>

namespace wct::sampling {

namespace {

constexpr int kSamples = 5; // steps along a facet's edge

struct Range {
    double above = 0.0;
    double below = 0.0;
    double missed = 0.0;
};

Range sample(const std::array<Vec3, 3> &corner, const domain::Reference &reference, int near) {
    Range range;
    for (int j = 0; j <= kSamples; ++j)
        for (int k = 0; k <= kSamples - j; ++k) {
            const double u = static_cast<double>(j) / kSamples;
            const double v = static_cast<double>(k) / kSamples;
            const Vec3 p = corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]);
            const domain::Foot foot = reference.nearest(p, -1, near);
            near = foot.triangle;
            const double height = reference.height(p, foot);
            range.above = std::max(range.above, height);
            range.below = std::min(range.below, height);
        }
    return range;
}

double volume_of(const Cloud &cloud, const RestrictedDelaunay &complex) {
    double volume = 0.0;
    for (std::size_t t = 0; t < complex.all.tets.size(); ++t) {
        if (complex.region[t] < 0)
            continue;
        const auto &tet = complex.all.tets[t];
        const auto &at = cloud.points;
        volume += six_volumes(at[tet[0]], at[tet[1]], at[tet[2]], at[tet[3]]) / 6.0;
    }
    return volume;
}

/// Volume between the reference's sides that are inside and those that are outside.
double enclosed_volume(const domain::SurfaceData &data) {
    double volume = 0.0;
    const Vec3 &o = data.points[data.triangles[0][0]];
    for (std::size_t t = 0; t < data.triangles.size(); ++t) {
        const auto &[a, b, c] = data.triangles[t];
        const auto &sides = data.sides[data.patch[t]];
        if ((sides[0] < 0) != (sides[1] < 0))
            volume +=
                (sides[0] < 0 ? -1.0 : 1.0) * six_volumes(o, data.points[a], data.points[b], data.points[c]) / 6.0;
    }
    return volume;
}

std::vector<Range> ranges_of(const Cloud &cloud, const std::vector<Facet> &facets, const domain::Reference &reference,
                             const Workers &workers) {
    std::vector<Range> range(facets.size());
    workers.for_each(facets.size(), 64, [&](std::size_t f) {
        const auto &[a, b, c] = facets[f];
        const int near = std::max({cloud.near[a], cloud.near[b], cloud.near[c]});
        range[f] = sample({cloud.points[a], cloud.points[b], cloud.points[c]}, reference, near);
    });
    return range;
}

struct Near {
    double distance = 0.0;
    int facet = -1;
};

/// The facets nearest to the reference's vertices, then to the middles of its triangles; none for vertices without a
/// triangle.
std::vector<Near> nearest_facets(const Cloud &cloud, const std::vector<Facet> &facets, const domain::SurfaceData &data,
                                 const Workers &workers) {
    const geometry::TriangleTree tree(cloud.points, facets);
    const std::size_t vertices = data.points.size();
    std::vector<Near> back(vertices + data.triangles.size());
    std::vector<char> known(vertices, 0);
    for (const auto &triangle : data.triangles)
        for (const int v : triangle)
            known[v] = 1;
    workers.for_chunks(back.size(), 512, [&](std::size_t first, std::size_t last) {
        int near = -1;
        for (std::size_t i = first; i < last; ++i) {
            if (i < vertices && !known[i])
                continue;
            Vec3 p;
            if (i < vertices)
                p = data.points[i];
            else
                for (const int v : data.triangles[i - vertices])
                    p += data.points[v];
            const auto found = tree.nearest(i < vertices ? p : (1.0 / 3.0) * p, near);
            near = found.triangle;
            back[i] = {std::sqrt(found.square), found.triangle};
        }
    });
    return back;
}

/// Per point the mean over its facets.
std::vector<Range> mean_ranges(const Cloud &cloud, const std::vector<Facet> &facets, const std::vector<Range> &range) {
    std::vector<Range> mean(cloud.count());
    std::vector<double> count(cloud.count(), 0.0);
    for (std::size_t f = 0; f < facets.size(); ++f)
        for (const int v : facets[f]) {
            mean[v].above += range[f].above;
            mean[v].below += range[f].below;
            mean[v].missed += range[f].missed;
            count[v] += 1.0;
        }
    for (std::size_t v = 0; v < mean.size(); ++v)
        if (count[v] > 0.0)
            mean[v] = {mean[v].above / count[v], mean[v].below / count[v], mean[v].missed / count[v]};
    return mean;
}

/// Per vertex of the reference the greatest of the means at the corners of the facet nearest to it.
void take_to_reference(const std::vector<Range> &mean, const std::vector<Facet> &facets, const std::vector<Near> &back,
                       std::size_t vertices, Deviation &out) {
    out.above.assign(vertices, 0.0);
    out.below.assign(vertices, 0.0);
    out.missed.assign(vertices, 0.0);
    for (std::size_t v = 0; v < vertices; ++v) {
        if (back[v].facet < 0)
            continue;
        for (const int w : facets[back[v].facet]) {
            out.above[v] = std::max(out.above[v], mean[w].above);
            out.below[v] = std::min(out.below[v], mean[w].below);
            out.missed[v] = std::max(out.missed[v], mean[w].missed);
        }
    }
}

} // namespace

Deviation measure_deviation(const Cloud &cloud, const RestrictedDelaunay &complex, const domain::Reference &reference,
                            const Workers &workers) {
    const std::vector<Facet> facets = surface_facets(complex);
    std::vector<Range> range = ranges_of(cloud, facets, reference, workers);
    const std::vector<Near> back = nearest_facets(cloud, facets, reference.data(), workers);
    Deviation out;
    for (const Near &at : back)
        if (at.facet >= 0) {
            range[at.facet].missed = std::max(range[at.facet].missed, at.distance);
            out.most_in = std::max(out.most_in, at.distance);
        }
    for (const Range &r : range)
        out.most_out = std::max({out.most_out, r.above, -r.below});
    take_to_reference(mean_ranges(cloud, facets, range), facets, back, reference.data().points.size(), out);
    const double enclosed = enclosed_volume(reference.data());
    out.volume_gain = enclosed > 0.0 ? volume_of(cloud, complex) / enclosed - 1.0 : 0.0;
    return out;
}

} // namespace wct::sampling
