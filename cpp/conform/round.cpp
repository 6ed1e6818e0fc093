#include "conform/round.h"

#include "delaunay/flat_tets.h"
#include "sampling/pinch_mending.h"

#include <cmath>
#include <limits>

namespace wct::conform {

namespace {

constexpr double kApart = 0.1;     // of new points that bring a surface back, in sizes
constexpr double kThinnest = 1e-3; // layer, in radii of a facet's circle
constexpr double kGap = 0.4;       // of other new points from one at the center of a circle or sphere, in its radii
constexpr double kJitter = 0.1;    // longest way of a point from a center that others may share, in sizes

} // namespace

Round::Round(ConformingCloud &points, const domain::Reference &reference, const SurfaceProbes &probes,
             const domain::RegionMap &map, const ConformOptions &options, double sharpest, Random &random,
             const Workers &workers)
    : points_(points), cloud_(points.points()), reference_(reference), probes_(probes), map_(map), options_(options),
      sharpest_(sharpest), random_(random), spheres_(cloud_, complex_) {
    complex_ = sampling::labelled_delaunay(cloud_, map, workers);
    take_in_flat();
    delaunay::remove_flat(complex_.all, complex_.region, cloud_.points, sharpest_);
    several_ = *std::max_element(complex_.region.begin(), complex_.region.end()) > 0;
    spheres_.measure();
    peel();
    flaws_ = sampling::mend_pinches(cloud_, reference, complex_, sampling::find_flaws(cloud_, complex_));
    std::erase_if(flaws_.pinched, [&](int v) { return cloud_.role[v] == Stratum::corner; });
}

Faults Round::mend(double share) {
    gone_.assign(cloud_.count(), 0);
    points_.begin_round();
    mend_creases();
    mend_surface();
    mend_outer();
    mend_edges();
    if (options_.one_sided)
        mend_ties();
    if (faults_.all() == 0)
        mend_slivers(share);
    points_.remove(gone_);
    return faults_;
}

double Round::share(int t, int i, int v) const {
    auto f = complex_.facet(t, i);
    std::rotate(f.begin(), std::find(f.begin(), f.end(), v), f.end());
    const auto at = corners(f);
    return 0.25 * dot(at[1] - at[0], at[2] - at[0]) / norm(normal_of(at)) * spheres_.height(t, i);
}

bool Round::outer(int t, int i) const {
    return complex_.beyond(t, i) != complex_.region[t] && (options_.one_sided || several_);
}

bool Round::clear(const std::vector<int> &candidates, const geometry::Sphere &ball) {
    bool any = false;
    for (const int v : candidates)
        if (inside(v) && points_.origin()[v] >= 0 && norm(cloud_.points[v] - ball.center) < ball.radius) {
            gone_[v] = 1;
            any = true;
        }
    return any;
}

void Round::mend_creases() {
    std::vector<Edge> edges;
    for (std::size_t t = 0; t < complex_.all.tets.size(); ++t)
        if (complex_.region[t] >= 0)
            for (const auto &[i, j] : kEdges) {
                const int a = complex_.all.tets[t][i], b = complex_.all.tets[t][j];
                if (!inside(a) && !inside(b))
                    edges.push_back(sorted(a, b));
            }
    std::sort(edges.begin(), edges.end());
    std::vector<std::size_t> missing;
    for (std::size_t k = 0; k < points_.segments().size(); ++k) {
        const auto &[a, b, curve] = points_.segments()[k];
        if (!std::binary_search(edges.begin(), edges.end(), sorted(a, b)))
            missing.push_back(k);
    }
    faults_.creases = missing.size();
    for (const std::size_t k : missing) {
        const auto [a, b, curve] = points_.segments()[k];
        const Vec3 &p = cloud_.points[a], &q = cloud_.points[b];
        if (!clear(all_inside(), {0.5 * (p + q), 0.5 * norm(q - p)}))
            points_.split(k);
    }
}

const std::vector<int> &Round::all_inside() {
    if (all_inside_.empty())
        for (std::size_t v = 0; v < gone_.size(); ++v)
            if (inside(static_cast<int>(v)))
                all_inside_.push_back(static_cast<int>(v));
    return all_inside_;
}

void Round::mend_surface() {
    std::vector<char> used(cloud_.count(), 0);
    for (std::size_t t = 0; t < complex_.all.tets.size(); ++t)
        if (complex_.region[t] >= 0)
            for (const int v : complex_.all.tets[t])
                used[v] = 1;
    const auto bare = static_cast<std::size_t>(std::count(used.begin(), used.end(), 0));
    faults_.surface = flaws_.exposed.size() + flaws_.pinched.size() + bare;
    for (const int v : flaws_.exposed)
        gone_[v] = 1;
    std::vector<char> pinched(cloud_.count(), 0);
    for (const int v : flaws_.pinched)
        pinched[v] = 1;
    const auto facets = sampling::surface_facets(complex_);
    for (const auto &f : facets) {
        if (inside(f[0]) || inside(f[1]) || inside(f[2]))
            continue;
        const bool touches = pinched[f[0]] || pinched[f[1]] || pinched[f[2]];
        if (!touches && probes_.is_own(f, points_.origin()))
            continue;
        const domain::Foot worst =
            probes_.farthest(corners(f), touches || sampling::shared_patches(cloud_, reference_, f).empty());
        if (worst.triangle >= 0) {
            faults_.off += !touches;
            restore(worst);
        }
    }
    for (const domain::Foot &foot : probes_.missed(cloud_.points, facets, points_.origin())) {
        ++faults_.off;
        restore(foot);
    }
}

void Round::restore(const domain::Foot &foot) {
    const auto &own = reference_.data().triangles[foot.triangle];
    const auto &at = reference_.data().points;
    const geometry::Sphere ball = geometry::circumsphere(std::array{at[own[0]], at[own[1]], at[own[2]]});
    double size = 0.0; // of the nearest corner
    for (double least = std::numeric_limits<double>::infinity(); const int v : own)
        if (const double far = norm(foot.point - at[v]); far < least) {
            least = far;
            size = points_.size_of_own(v);
        }
    if (!clear(all_inside(), ball))
        points_.insert_on_patch(foot.point, reference_.data().patch[foot.triangle], size, kApart * size);
}

void Round::mend_outer() {
    // Where a bend is too sharp for the flip that would help, a point on it halves what the flip cuts off.
    for (const auto &[t, foot] : ridges_) {
        if (complex_.region[t] >= 0)
            restore(foot);
    }
    for (int t = 0; t < static_cast<int>(spheres_.size()); ++t)
        for (int i = 0; i < 4; ++i) {
            if (complex_.region[t] < 0 || !outer(t, i) || !beyond(t, i))
                continue;
            ++faults_.outer;
            const auto f = complex_.facet(t, i);
            const int apex = complex_.all.tets[t][i];
            if (inside(apex) && points_.origin()[apex] >= 0)
                gone_[apex] = 1;
            else
                split_facet(f, 0.0);
        }
}

void Round::mend_edges() {
    struct Share {
        std::array<int, 3> edge; // and the region
        double area;
        Facet outer; // the facet, if it is an outer one
    };
    std::vector<char> open(cloud_.count(), 0);
    for (int t = 0; t < static_cast<int>(spheres_.size()); ++t)
        for (int i = 0; i < 4; ++i)
            if (complex_.region[t] >= 0 && outer(t, i))
                for (const int v : complex_.facet(t, i))
                    open[v] = 1;
    std::vector<Share> shares;
    for (int t = 0; t < static_cast<int>(spheres_.size()); ++t)
        for (int i = 0; i < 4; ++i) {
            if (complex_.region[t] < 0)
                continue;
            const auto f = complex_.facet(t, i);
            const bool is_outer = outer(t, i);
            for (int k = 0; k < 3; ++k) {
                const int a = f[(k + 1) % 3], b = f[(k + 2) % 3];
                if (open[a] && open[b])
                    shares.push_back({{std::min(a, b), std::max(a, b), complex_.region[t]},
                                      share(t, i, f[k]),
                                      is_outer ? std::array{f[k], a, b} : std::array{-1, a, b}});
            }
        }
    std::stable_sort(shares.begin(), shares.end(), [](const Share &a, const Share &b) { return a.edge < b.edge; });
    for (std::size_t k = 0, end = 0; k < shares.size(); k = end) {
        double area = 0.0;
        std::vector<Facet> outer;
        for (end = k; end < shares.size() && shares[end].edge == shares[k].edge; ++end) {
            area += shares[end].area;
            if (shares[end].outer[0] >= 0)
                outer.push_back(shares[end].outer);
        }
        const auto &[a, b, region] = shares[k].edge;
        if (outer.empty() || area > least() * norm(cloud_.points[a] - cloud_.points[b]))
            continue;
        ++faults_.edges;
        split_facet(*std::min_element(outer.begin(), outer.end(),
                                      [&](const auto &f, const auto &g) { return cosine(f) < cosine(g); }),
                    kOff);
    }
}

double Round::cosine(const Facet &f) const {
    const auto at = corners(f);
    return dot(unit(at[1] - at[0]), unit(at[2] - at[0]));
}

void Round::split_facet(const Facet &f, double off) {
    const std::vector<int> shared = sampling::shared_patches(cloud_, reference_, f);
    if (shared.empty())
        return; // it is off the surface in any case
    const auto at = corners(f);
    geometry::Sphere ball = geometry::circumsphere(at);
    const Vec3 u = unit(at[1] - at[0]), v = cross(unit(normal_of(at)), u);
    ball.center += ball.radius * off * ((random_.uniform() - 0.5) * u + (random_.uniform() - 0.5) * v);
    const int patch = shared.size() == 1 ? shared[0] : nearest_of(shared, (1.0 / 3.0) * (at[0] + at[1] + at[2]));
    const Vec3 on = reference_.nearest(ball.center, patch).point;
    points_.insert_on_patch(on, patch, size_of(f), kGap * ball.radius);
    if (!options_.one_sided)
        mirror(on, unit(normal_of(at)), ball.radius, size_of(f));
}

void Round::mirror(const Vec3 &on, const Vec3 &normal, double radius, double size) {
    for (const double side : {-1.0, 1.0}) {
        int triangle = -1;
        const double far = reference_.ray(on, side * normal, kThinnest * radius, radius, triangle);
        if (triangle >= 0)
            points_.insert_on_patch(on + far * side * normal, reference_.data().patch[triangle], size, kGap * radius);
    }
}

int Round::nearest_of(const std::vector<int> &patches, const Vec3 &p) const {
    return *std::min_element(patches.begin(), patches.end(), [&](int a, int b) {
        return reference_.nearest(p, a).distance < reference_.nearest(p, b).distance;
    });
}

double Round::size_of(const Facet &f) const {
    return (cloud_.size[f[0]] + cloud_.size[f[1]] + cloud_.size[f[2]]) / 3.0;
}

void Round::mend_ties() {
    std::vector<char> moved(gone_.size(), 0);
    for (int t = 0; t < static_cast<int>(spheres_.size()); ++t)
        for (int i = 0; i < 4; ++i) {
            const int next = complex_.all.neighbours[t][i];
            if (complex_.region[t] < 0 || next < t || outer(t, i))
                continue;
            if (!spheres_.tied(t, i, options_.least))
                continue;
            ++faults_.ties;
            mend_tie(t, i, complex_.apex_beyond(t, i), moved);
        }
}

void Round::put_inside(int t) {
    const double size = size_of(complex_.facet(t, 0));
    Vec3 p = spheres_[t].center;
    if (map_.region(p, -1) != complex_.region[t])
        p = cloud_.centroid(complex_.all.tets[t]);
    points_.insert_inside(p + kJitter * size * random_.uniform() * unit(random_.normal3()), complex_.region[t], size,
                          kGap * std::min(size, spheres_[t].radius));
}

void Round::mend_tie(int t, int i, int other, std::vector<char> &moved) {
    constexpr double flat = 1e-6, step = 0.03;
    const auto f = complex_.facet(t, i);
    const int apex = complex_.all.tets[t][i];
    // Four surface points on a circle are on one sphere with every fifth: only a point between them helps.
    for (int k = 0; k < 3; ++k) {
        const Tet four{apex, f[k], other, f[(k + 1) % 3]};
        if (std::any_of(four.begin(), four.end(), [&](int v) { return inside(v); }))
            continue;
        const auto at = corners(std::array{four[0], four[1], four[2]});
        const geometry::Sphere ball = geometry::circumsphere(at);
        const Vec3 &last = cloud_.points[four[3]];
        if (std::fabs(dot(unit(normal_of(at)), last - at[0])) > flat * ball.radius ||
            std::fabs(norm(last - ball.center) - ball.radius) > flat * ball.radius)
            continue;
        if (!sampling::shared_patches(cloud_, reference_, four).empty()) {
            split_facet({four[0], four[1], four[2]}, kOff);
        } else {
            const Vec3 p = ball.center + 0.5 * kOff * ball.radius * unit(random_.normal3());
            points_.insert_inside(p, complex_.region[t], size_of(f), kGap * ball.radius);
        }
        return;
    }
    std::vector<int> free;
    for (const int v : {f[0], f[1], f[2], apex, other})
        if (inside(v))
            free.push_back(v);
    if (free.empty()) {
        put_inside(t);
        return;
    }
    const int v = free[random_.below(static_cast<int>(free.size()))];
    if (!moved[v] && !gone_[v])
        points_.shift(v, step * cloud_.size[v] * random_.normal3());
    moved[v] = 1;
}

} // namespace wct::conform
