#include "domain/passing_creases.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wct::domain {

namespace {

/// What a crease passes.
struct Passed {
    std::vector<int> curves, patches;
};

Passed passed_by(const Reference &reference, int own) {
    const auto &curves = reference.curves();
    const auto &vertices = curves[own].vertices;
    const auto is_end = [&](int v) { return v == vertices.front() || v == vertices.back(); };
    std::vector<char> met(reference.data().sides.size(), 0);
    for (const int v : vertices)
        for (const int patch : reference.patches_at_vertex(v))
            met[patch] = 1;
    Passed out;
    for (int c = 0; c < static_cast<int>(curves.size()); ++c) {
        const auto &other = curves[c].vertices;
        if (reference.share_patch(own, c)) {
            for (const int patch : reference.patches_at_curve(c))
                met[patch] = 1;
        } else if (!other.empty() && !is_end(other.front()) && !is_end(other.back())) {
            out.curves.push_back(c);
        }
    }
    for (int patch = 0; patch < static_cast<int>(met.size()); ++patch)
        if (!met[patch])
            out.patches.push_back(patch);
    return out;
}

} // namespace

std::vector<double> passing_distances(const Reference &reference, std::span<const double> reach) {
    const auto &data = reference.data();
    const auto &curves = reference.curves();
    std::vector<geometry::Box> of_curve(curves.size()), of_patch(data.sides.size());
    for (std::size_t c = 0; c < curves.size(); ++c)
        for (const int v : curves[c].vertices)
            of_curve[c].add(data.points[v]);
    for (std::size_t t = 0; t < data.triangles.size(); ++t)
        for (const int v : data.triangles[t])
            of_patch[data.patch[t]].add(data.points[v]);
    std::vector<double> out(data.points.size(), std::numeric_limits<double>::infinity());
    const auto is_near = [&](int v, const geometry::Box &box) {
        return std::sqrt(box.square(data.points[v])) < std::min(reach[v], out[v]);
    };
    for (int own = 0; own < static_cast<int>(curves.size()); ++own) {
        if (curves[own].vertices.empty()) // given up
            continue;
        const Passed passed = passed_by(reference, own);
        for (const int v : curves[own].vertices) {
            for (const int c : passed.curves)
                if (is_near(v, of_curve[c]))
                    out[v] = std::min(out[v], reference.nearest_on_curve(data.points[v], c).distance);
            for (const int patch : passed.patches)
                if (is_near(v, of_patch[patch]))
                    out[v] = std::min(out[v], reference.nearest(data.points[v], patch).distance);
        }
    }
    return out;
}

} // namespace wct::domain
