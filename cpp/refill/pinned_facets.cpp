#include "refill/pinned_facets.h"

#include "base/facet_uses.h"
#include "delaunay/cocircular_diagonals.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wct::refill {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

} // namespace

PinnedFacets::PinnedFacets(const domain::InputMesh &mesh, std::span<const Facet> facets,
                           const std::vector<char> &pinned, std::span<const Edge> edges, bool squares)
    : mesh_(mesh), pinned_(pinned), squares_(squares), facets_(facets.begin(), facets.end()),
      kept_(mesh.tets.size(), 0) {
    for (Facet &facet : facets_)
        ascend(facet);
    std::sort(facets_.begin(), facets_.end());
    // Edges away from the facets have nothing that holds them in a triangulation.
    std::vector<Edge> held, loose;
    for (const auto &[a, b, c] : facets_)
        for (const Edge &edge : {Edge{a, b}, Edge{a, c}, Edge{b, c}})
            held.push_back(edge);
    std::sort(held.begin(), held.end());
    for (const auto &[a, b] : edges)
        if (const Edge edge = sorted(a, b); !std::binary_search(held.begin(), held.end(), edge))
            loose.push_back(edge);
    std::sort(loose.begin(), loose.end());
    for (std::size_t t = 0; t < mesh.tets.size() && !loose.empty(); ++t)
        for (const auto &e : kEdges) {
            const int a = mesh.tets[t][e[0]], b = mesh.tets[t][e[1]];
            if (std::binary_search(loose.begin(), loose.end(), sorted(a, b)))
                kept_[t] = 1;
        }
    std::vector<char> missing;
    std::vector<geometry::Sphere> balls;
    do {
        kept_count_ = static_cast<std::size_t>(std::count(kept_.begin(), kept_.end(), 1));
        if (keeps_all())
            return;
        gather();
        std::vector<Vec3> at;
        for (const int v : points_)
            at.push_back(mesh.points[v]);
        delaunay::Triangulation all = delaunay::delaunay(at);
        recover(all, at);
        balls = protect(all, missing);
    } while (keep_behind(missing));
    balls_ = geometry::ProtectingBalls(std::move(balls));
}

/// The facets between what is kept and what is not, with what lies on either side.
void PinnedFacets::gather() {
    sides_.clear();
    behind_.clear();
    std::vector<char> used(mesh_.points.size(), 0);
    FacetUses(mesh_.tets, mesh_.points.size()).each([&](const Facet &facet, std::span<const FacetUses::Use> uses) {
        Sides sides{facet};
        std::array<int, 2> open{-1, -1};
        bool some_kept = false;
        for (const FacetUses::Use &use : uses) {
            const int t = use.tet();
            if (kept_[t]) {
                some_kept = true;
                continue;
            }
            Facet turned = inward_facet(mesh_.tets[t], use.corner());
            const bool above = ascend(turned); // the facet's normal points into the tet
            sides.region[above] = mesh_.region[t];
            open[above] = t;
        }
        if (open == std::array{-1, -1} || !(some_kept || std::binary_search(facets_.begin(), facets_.end(), facet)))
            return;
        for (const int v : facet)
            used[v] = 1;
        sides_.push_back(sides);
        behind_.push_back(open);
    });
    for (std::size_t t = 0; t < mesh_.tets.size(); ++t)
        for (const int v : mesh_.tets[t])
            if (!kept_[t] && pinned_[v])
                used[v] = 1;
    points_.clear();
    std::vector<int> place(used.size(), -1);
    for (std::size_t v = 0; v < used.size(); ++v)
        if (used[v]) {
            place[v] = static_cast<int>(points_.size());
            points_.push_back(static_cast<int>(v));
        }
    for (Sides &sides : sides_) // places ascend with the points: so do the facets
        for (int &v : sides.facet)
            v = place[v];
}

int PinnedFacets::find(const Facet &facet) const {
    const auto at = std::lower_bound(sides_.begin(), sides_.end(), facet,
                                     [](const Sides &sides, const Facet &f) { return sides.facet < f; });
    return at != sides_.end() && at->facet == facet ? static_cast<int>(at - sides_.begin()) : -1;
}

std::array<Vec3, 3> PinnedFacets::corners(std::size_t k) const {
    const auto &[a, b, c] = sides_[k].facet;
    return {mesh_.points[points_[a]], mesh_.points[points_[b]], mesh_.points[points_[c]]};
}

template <class Visit> void PinnedFacets::each_pinned(const std::vector<Tet> &tets, const Visit &visit) const {
    const auto count = static_cast<int>(points_.size());
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (int i = 0; i < 4; ++i) {
            Facet facet = inward_facet(tets[t], i);
            if (std::max({facet[0], facet[1], facet[2]}) >= count) // most are, and the look-up is not free
                continue;
            const bool above = ascend(facet);
            if (const int k = find(facet); k >= 0)
                visit(t, i, k, above);
        }
}

void PinnedFacets::recover(delaunay::Triangulation &all, std::span<const Vec3> at) const {
    if (!squares_)
        return;
    delaunay::recover_facets(all, at, [&] {
        std::vector<char> seen(sides_.size(), 0);
        each_pinned(all.tets, [&](std::size_t, int, int k, bool) { seen[k] = 1; });
        std::vector<Facet> missing;
        for (std::size_t k = 0; k < sides_.size(); ++k)
            if (!seen[k])
                missing.push_back(sides_[k].facet);
        return missing;
    });
}

/// Find each facet's ball from the two tets at it in the triangulation of the pinned points alone.
std::vector<geometry::Sphere> PinnedFacets::protect(const delaunay::Triangulation &all,
                                                    std::vector<char> &missing) const {
    std::vector<std::array<double, 2>> limits(sides_.size(), {-kInfinity, kInfinity});
    missing.assign(sides_.size(), 1);
    std::vector<geometry::Sphere> balls;
    for (std::size_t k = 0; k < sides_.size(); ++k)
        balls.push_back(geometry::circumsphere(corners(k)));
    each_pinned(all.tets, [&](std::size_t t, int i, int k, bool above) {
        missing[k] = 0;
        const Vec3 n = unit(normal_of(corners(k)));
        const Vec3 d = mesh_.points[points_[all.tets[t][i]]] - balls[k].center;
        // Centers are balls[k].center + x n; at this x the sphere meets the apex.
        const double height = dot(n, d), power = dot(d, d) - balls[k].radius * balls[k].radius;
        const double x = height != 0.0 ? 0.5 * power / height : std::copysign(kInfinity, above ? power : -power);
        limits[k][above] = x;
    });
    std::vector<geometry::Box> boxes(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i)
        boxes[i].add(mesh_.points[points_[i]]);
    const geometry::BoxTree near(boxes);
    const auto empty = [&](const geometry::Sphere &ball) {
        const double square = ball.radius * ball.radius * (1.0 - 1e-9);
        return !near.visit([&](const geometry::Box &box) { return box.square(ball.center) < square; },
                           [&](std::size_t i) { return boxes[i].square(ball.center) < square; });
    };
    for (std::size_t k = 0; k < sides_.size(); ++k) {
        const auto [lo, hi] = limits[k];
        const auto ball =
            missing[k] ? std::nullopt : geometry::protecting_ball(balls[k], unit(normal_of(corners(k))), lo, hi);
        // Points on the smallest ball itself, as in squares, leave the choice that swap_diagonals makes.
        missing[k] = !ball && !(squares_ && empty(balls[k]));
        balls[k] = ball.value_or(balls[k]);
    }
    return balls;
}

/// Keep the input tets at facets without a ball; false if there are none.
bool PinnedFacets::keep_behind(const std::vector<char> &missing) {
    bool any = false;
    for (std::size_t k = 0; k < missing.size(); ++k)
        for (const int t : behind_[k])
            if (missing[k] && t >= 0) {
                kept_[t] = 1;
                any = true;
            }
    return any;
}

bool PinnedFacets::label(sampling::RestrictedDelaunay &complex, std::span<const Vec3> at) const {
    recover(complex.all, at);
    const auto &tets = complex.all.tets;
    constexpr int kUnknown = -2;
    complex.region.assign(tets.size(), kUnknown);
    std::vector<std::uint8_t> wall(tets.size(), 0); // bit i: facet i is pinned
    std::vector<char> seen(sides_.size(), 0);
    std::vector<int> queue;
    each_pinned(tets, [&](std::size_t t, int i, int k, bool above) {
        seen[k] = 1;
        wall[t] |= static_cast<std::uint8_t>(1u << i);
        if (complex.region[t] == kUnknown)
            queue.push_back(static_cast<int>(t));
        complex.region[t] = sides_[k].region[above];
    });
    for (std::size_t k = 0; k < queue.size(); ++k)
        for (int i = 0; i < 4; ++i) {
            const int t = queue[k], next = complex.all.neighbours[t][i];
            if (next < 0 || (wall[t] >> i & 1) || complex.region[next] != kUnknown)
                continue;
            complex.region[next] = complex.region[t];
            queue.push_back(next);
        }
    std::replace(complex.region.begin(), complex.region.end(), kUnknown, -1);
    return std::find(seen.begin(), seen.end(), 0) == seen.end();
}

} // namespace wct::refill
