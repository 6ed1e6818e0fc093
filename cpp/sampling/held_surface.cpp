#include "sampling/held_surface.h"

#include "delaunay/cocircular_diagonals.h"
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wct::sampling {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::array<double, 3> place(const Vec3 &p) {
    return {p.x, p.y, p.z};
}

} // namespace

HeldSurface::HeldSurface(const HeldFacets &facets, const domain::Reference &reference)
    : reference_(reference), held_(facets), patches_(facets.patch.begin(), facets.patch.end()),
      curves_(facets.curves.begin(), facets.curves.end()) {
    for (int c = 0; c < static_cast<int>(reference.curves().size()); ++c) {
        const std::vector<int> &beside = reference.patches_at_curve(c);
        if (std::any_of(beside.begin(), beside.end(), [&](int patch) { return patches_.contains(patch); }))
            curves_.insert(c);
    }
    for (std::size_t i = 0; i < held_.points.size(); ++i) {
        at_.emplace(place(held_.points[i]), static_cast<int>(i));
        if (held_.role[i] == Stratum::corner)
            corners_.insert(held_.label[i]);
    }
    std::vector<double> sum(held_.points.size(), 0.0), count(held_.points.size(), 0.0);
    const auto measure = [&](int v, int w) {
        for (const int u : {v, w}) {
            sum[u] += norm(held_.points[v] - held_.points[w]);
            count[u] += 1.0;
        }
    };
    for (const auto &[v, w] : held_.edges)
        measure(v, w);
    for (std::size_t k = 0; k < held_.facets.size(); ++k) {
        Facet key = held_.facets[k];
        for (int i = 0; i < 3; ++i)
            measure(key[i], key[(i + 1) % 3]);
        ascend(key);
        facet_.emplace(key, static_cast<int>(k));
    }
    for (std::size_t i = 0; i < sum.size(); ++i)
        size_.push_back(count[i] > 0.0 ? sum[i] / count[i] : 0.0);
    protect();
}

/// With x the height of a ball's center over its facet's plane, every point rules out the x beyond one bound.
void HeldSurface::protect() {
    constexpr double on = 1e-9; // as near points are on the ball itself, in squares of radii
    std::vector<geometry::Sphere> balls;
    std::vector<Vec3> others = held_.points;
    for (const int v : reference_.data().corners)
        if (!corners_.contains(v))
            others.push_back(reference_.data().points[v]);
    for (const Facet &facet : held_.facets) {
        const std::array corners{held_.points[facet[0]], held_.points[facet[1]], held_.points[facet[2]]};
        const Vec3 n = unit(normal_of(corners));
        const geometry::Sphere ball = geometry::circumsphere(corners);
        double lo = -kInfinity, hi = kInfinity;
        for (int i = 0; i < static_cast<int>(others.size()); ++i) {
            if (std::find(facet.begin(), facet.end(), i) != facet.end())
                continue;
            const Vec3 d = others[i] - ball.center;
            const double height = dot(n, d), power = dot(d, d) - ball.radius * ball.radius;
            if (std::fabs(height) < on * ball.radius) {
                if (power < -on * ball.radius * ball.radius)
                    lo = kInfinity;
                continue;
            }
            const double bound = 0.5 * power / height;
            (height > 0.0 ? hi : lo) = height > 0.0 ? std::min(hi, bound) : std::max(lo, bound);
        }
        if (const auto protecting = geometry::protecting_ball(ball, n, lo, hi))
            balls.push_back(*protecting);
    }
    protect_edges(others, balls);
    balls_ = geometry::ProtectingBalls(std::move(balls));
}

void HeldSurface::protect_edges(std::span<const Vec3> others, std::vector<geometry::Sphere> &balls) const {
    for (const Edge &edge : held_.edges) {
        const Vec3 &p = held_.points[edge[0]], &q = held_.points[edge[1]];
        const geometry::Sphere ball{0.5 * (p + q), 0.5 * norm(q - p)};
        const bool empty = std::none_of(others.begin(), others.end(), [&](const Vec3 &other) {
            return !(other == p) && !(other == q) && norm(other - ball.center) < ball.radius;
        });
        if (empty)
            balls.push_back(ball);
    }
}

bool HeldSurface::holds(Stratum role, int label) const {
    switch (role) {
    case Stratum::patch:
        return patches_.contains(label);
    case Stratum::crease:
        return curves_.contains(label);
    case Stratum::corner:
        return corners_.contains(label);
    case Stratum::interior:
        break;
    }
    return false;
}

void HeldSurface::set_sizes(domain::Sizing &sizing) const {
    const auto &data = reference_.data();
    for (const int c : held_.curves)
        for (const int v : reference_.curves()[c].vertices) {
            double least = kInfinity;
            for (const Edge &edge : held_.edges)
                for (const int w : edge)
                    if (const double far = norm(held_.points[w] - data.points[v]); far < least) {
                        least = far;
                        sizing.surface[v] = size_[w];
                    }
        }
    std::set<int> vertices;
    for (std::size_t t = 0; t < data.triangles.size(); ++t)
        if (patches_.contains(data.patch[t]))
            vertices.insert(data.triangles[t].begin(), data.triangles[t].end());
    const geometry::TriangleTree tree(held_.points, held_.facets);
    for (const int v : vertices) { // none where no facets are held
        const auto near = tree.nearest(data.points[v]);
        double size = 0.0;
        for (int i = 0; i < 3; ++i)
            size += near.weight[i] * size_[held_.facets[near.triangle][i]];
        sizing.surface[v] = size;
    }
    sizing.grade();
}

void HeldSurface::put(Cloud &cloud, const domain::Sizing &sizing) const {
    std::vector<char> keep(cloud.count());
    for (std::size_t i = 0; i < cloud.count(); ++i)
        keep[i] = !holds(cloud.role[i], cloud.label[i]);
    cloud.keep(keep);
    for (std::size_t i = 0; i < held_.points.size(); ++i) {
        cloud.add(held_.points[i], held_.role[i], held_.label[i], sizing.at(held_.points[i]));
        cloud.held.back() = Hold::given;
    }
}

void HeldSurface::drop_others(Cloud &cloud) const {
    std::vector<char> keep(cloud.count());
    for (std::size_t i = 0; i < cloud.count(); ++i)
        keep[i] = cloud.held[i] == Hold::given || !holds(cloud.role[i], cloud.label[i]);
    cloud.keep(keep);
}

bool HeldSurface::clear(Vec3 &p, Stratum role, int label) const {
    if (role == Stratum::corner)
        return !balls_.contains(p);
    return balls_.clear(p, [&](Vec3 &moved) {
        if (role == Stratum::patch)
            reference_.to_patch(moved, reference_.nearest(moved, label));
        else if (role == Stratum::crease)
            reference_.to_curve(moved, label);
    });
}

void HeldSurface::clear(Cloud &cloud) const {
    constexpr double apart = 0.35; // of the size, from other points
    std::vector<char> keep(cloud.count(), 1);
    std::vector<std::size_t> moved;
    PointGrid grid;
    for (std::size_t i = 0; i < cloud.count(); ++i) {
        const Vec3 before = cloud.points[i];
        if (cloud.held[i] < Hold::all && cloud.role[i] != Stratum::corner) {
            keep[i] = clear(cloud.points[i], cloud.role[i], cloud.label[i]);
            if (keep[i] && !(cloud.points[i] == before)) {
                moved.push_back(i);
                continue;
            }
        }
        if (keep[i])
            grid.add(cloud.points[i], apart * cloud.size[i]);
    }
    for (const std::size_t i : moved) {
        keep[i] = !grid.crowded(cloud.points[i], apart * cloud.size[i]);
        if (keep[i])
            grid.add(cloud.points[i], apart * cloud.size[i]);
    }
    cloud.keep(keep);
}

std::vector<int> HeldSurface::numbers(const Cloud &cloud) const {
    std::vector<int> number(cloud.count(), -1);
    for (std::size_t i = 0; i < cloud.count(); ++i)
        if (cloud.held[i] == Hold::given)
            if (const auto found = at_.find(place(cloud.points[i])); found != at_.end())
                number[i] = found->second;
    return number;
}

template <class Visit>
void HeldSurface::each_held(const Cloud &cloud, const std::vector<Tet> &tets, const Visit &visit) const {
    const std::vector<int> number = numbers(cloud);
    for (std::size_t t = 0; t < tets.size(); ++t)
        for (int i = 0; i < 4; ++i) {
            const auto &[a, b, c] = inward_facet(tets[t], i);
            Facet key{number[a], number[b], number[c]};
            if (std::min({key[0], key[1], key[2]}) < 0)
                continue;
            const bool inward = ascend(key);
            const auto found = facet_.find(key);
            if (found == facet_.end())
                continue;
            Facet own = held_.facets[found->second];
            visit(t, i, found->second, inward == ascend(own));
        }
}

void HeldSurface::recover(const Cloud &cloud, delaunay::Triangulation &all) const {
    std::vector<int> at(held_.points.size(), -1);
    const std::vector<int> number = numbers(cloud);
    for (std::size_t i = 0; i < number.size(); ++i)
        if (number[i] >= 0)
            at[number[i]] = static_cast<int>(i);
    delaunay::recover_facets(all, cloud.points, [&] {
        std::vector<char> seen(held_.facets.size(), 0);
        each_held(cloud, all.tets, [&](std::size_t, int, int k, bool) { seen[k] = 1; });
        std::vector<Facet> missing;
        for (std::size_t k = 0; k < seen.size(); ++k) {
            Facet facet{at[held_.facets[k][0]], at[held_.facets[k][1]], at[held_.facets[k][2]]};
            ascend(facet);
            if (!seen[k] && facet[0] >= 0)
                missing.push_back(facet);
        }
        return missing;
    });
}

void HeldSurface::label(const Cloud &cloud, RestrictedDelaunay &complex) const {
    each_held(cloud, complex.all.tets, [&](std::size_t t, int, int k, bool above) {
        complex.region[t] = reference_.data().sides[held_.patch[k]][above];
    });
}

std::vector<int> HeldSurface::patches(const Cloud &cloud, std::span<const Facet> facets) const {
    const std::vector<int> number = numbers(cloud);
    std::vector<int> out;
    for (const Facet &facet : facets) {
        Facet key{number[facet[0]], number[facet[1]], number[facet[2]]};
        ascend(key);
        const auto found = facet_.find(key);
        out.push_back(found == facet_.end() ? -1 : held_.patch[found->second]);
    }
    return out;
}

bool HeldSurface::complete(const Cloud &cloud, const RestrictedDelaunay &complex) const {
    std::vector<char> seen(held_.facets.size(), 0);
    each_held(cloud, complex.all.tets, [&](std::size_t t, int i, int k, bool above) {
        const auto &sides = reference_.data().sides[held_.patch[k]];
        seen[k] =
            seen[k] || (complex.region[t] == sides[above] && complex.beyond(static_cast<int>(t), i) == sides[!above]);
    });
    if (std::find(seen.begin(), seen.end(), 0) != seen.end())
        return false;
    const std::vector<int> number = numbers(cloud);
    std::set<Edge> edges;
    for (std::size_t t = 0; t < complex.all.tets.size(); ++t)
        for (const auto &[i, j] : kEdges) {
            const int v = number[complex.all.tets[t][i]], w = number[complex.all.tets[t][j]];
            if (complex.region[t] >= 0 && v >= 0 && w >= 0)
                edges.insert(sorted(v, w));
        }
    return std::all_of(held_.edges.begin(), held_.edges.end(),
                       [&](const Edge &edge) { return edges.contains(sorted(edge[0], edge[1])); });
}

} // namespace wct::sampling
