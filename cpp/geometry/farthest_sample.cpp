#include "geometry/farthest_sample.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace wct::geometry {

namespace {

constexpr std::size_t kChunk = 128; // triangles

/// Samples one after the other, each near the one before.
class Search {
  public:
    explicit Search(const TriangleTree &surface) : surface_(surface) {}

    void look(const Vec3 &p) {
        const auto found = surface_.nearest(p, hint_, square_); // how near others are does not matter
        hint_ = found.triangle;
        if (found.square > square_ || square_ < 0.0) {
            square_ = found.square;
            at_ = p;
        }
    }
    Farthest found() const { return {std::sqrt(std::max(0.0, square_)), at_}; }

  private:
    const TriangleTree &surface_;
    int hint_ = -1;
    double square_ = -1.0; // no sample yet
    Vec3 at_;
};

} // namespace

Farthest farthest_sample(std::span<const Vec3> points, std::span<const Facet> triangles, double step,
                         const TriangleTree &surface, const Workers &workers) {
    std::vector<char> first(3 * triangles.size(), 0); // corners that no triangle before has
    std::vector<char> known(points.size(), 0);
    for (std::size_t k = 0; k < first.size(); ++k)
        first[k] = !std::exchange(known[triangles[k / 3][k % 3]], 1);
    std::vector<Farthest> found((triangles.size() + kChunk - 1) / kChunk);
    workers.for_chunks(triangles.size(), kChunk, [&](std::size_t begin, std::size_t end) {
        Search search(surface);
        for (std::size_t t = begin; t < end; ++t) {
            const Vec3 &a = points[triangles[t][0]], &b = points[triangles[t][1]], &c = points[triangles[t][2]];
            const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
            const int count = step > 0.0 ? static_cast<int>(std::ceil(longest / step)) : 1;
            for (int k = 0; k < 3; ++k)
                if (first[3 * t + k])
                    search.look(points[triangles[t][k]]);
            for (int i = 0; i <= count; ++i)
                for (int j = 0; j <= count - i; ++j)
                    if (const int k = count - i - j; std::max({i, j, k}) < count)
                        search.look((1.0 / count) * (static_cast<double>(i) * a + static_cast<double>(j) * b +
                                                     static_cast<double>(k) * c));
        }
        found[begin / kChunk] = search.found();
    });
    return *std::max_element(found.begin(), found.end(),
                             [](const Farthest &a, const Farthest &b) { return a.distance < b.distance; });
}

} // namespace wct::geometry
