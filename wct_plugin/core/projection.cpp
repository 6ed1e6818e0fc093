#include "projection.h"

#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>

namespace wct {

namespace {

/// How far pieces may lie off a plane or line and still be it: rounding of the coordinates, nothing more.
template <std::size_t corners> double rounding(const std::vector<std::array<Vec3, corners>> &pieces) {
    const Vec3 origin = pieces.front().front();
    double extent = 0.0;
    double size = 0.0;
    for (const auto &piece : pieces)
        for (const Vec3 &corner : piece) {
            extent = std::max(extent, norm(corner - origin));
            size = std::max({size, std::fabs(corner.x), std::fabs(corner.y), std::fabs(corner.z)});
        }
    return 1e-13 * extent + 8.0 * std::numeric_limits<double>::epsilon() * size;
}

/// The pieces of every label.
template <std::size_t corners>
std::map<std::int64_t, std::vector<std::array<Vec3, corners>>>
by_label(const std::vector<Vec3> &points, const std::vector<std::array<std::int32_t, corners>> &pieces,
         const std::vector<std::int64_t> &labels) {
    std::map<std::int64_t, std::vector<std::array<Vec3, corners>>> out;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        std::array<Vec3, corners> piece;
        for (std::size_t k = 0; k < corners; ++k)
            piece[k] = points[static_cast<std::size_t>(pieces[i][k])];
        out[labels[i]].push_back(piece);
    }
    return out;
}

Vec3 normal_of(const std::array<Vec3, 3> &t) {
    const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
    const double length = norm(n);
    return length > 0.0 ? (1.0 / length) * n : n;
}

Vec3 direction_of(const std::array<Vec3, 2> &s) {
    const Vec3 d = s[1] - s[0];
    const double length = norm(d);
    return length > 0.0 ? (1.0 / length) * d : d;
}

template <class... Functions> struct Overload : Functions... {
    using Functions::operator()...;
};

} // namespace

Domain::Domain(const Problem &problem) : where_(problem.points.size(), kFixed), last_(problem.points.size(), 0) {
    auto triangles = by_label(problem.points, problem.triangles, problem.triangle_patch);
    auto segments = by_label(problem.points, problem.segments, problem.segment_curve);
    std::map<std::int64_t, std::int32_t> patches;
    std::map<std::int64_t, std::int32_t> curves;
    const auto settle = [this](auto &pieces, auto &known, std::size_t point, std::int64_t label, const char *kind) {
        if (const auto seen = known.find(label); seen != known.end()) {
            where_[point] = seen->second;
            return;
        }
        const auto found = pieces.find(label);
        if (found == pieces.end())
            throw std::invalid_argument(std::string(kind) + " " + std::to_string(label) +
                                        " has points that move but no piece to move on");
        where_[point] = known[label] = static_cast<std::int32_t>(supports_.size());
        supports_.push_back(support_of(std::move(found->second)));
    };
    for (std::size_t p = 0; p < problem.points.size(); ++p)
        switch (problem.stratum[p]) {
        case Stratum::interior:
            where_[p] = kInterior;
            break;
        case Stratum::patch:
            settle(triangles, patches, p, problem.label[p], "patch");
            break;
        case Stratum::crease:
            settle(segments, curves, p, problem.label[p], "curve");
            break;
        case Stratum::corner:
            break;
        }
}

Domain::Support Domain::support_of(std::vector<std::array<Vec3, 3>> triangles) {
    // The normal of the sum of all triangles, each turned to the side of the largest: small ones have poor normals.
    Vec3 largest;
    for (const auto &t : triangles) {
        const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
        if (dot(n, n) > dot(largest, largest))
            largest = n;
    }
    Vec3 sum;
    for (const auto &t : triangles) {
        const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
        if (dot(n, largest) < 0.0)
            sum -= n;
        else
            sum += n;
    }
    if (norm(sum) > 0.0) {
        const Plane plane{triangles.front().front(), (1.0 / norm(sum)) * sum};
        const double allowed = rounding(triangles);
        bool flat = true;
        for (const auto &t : triangles)
            for (const Vec3 &corner : t)
                flat = flat && std::fabs(dot(corner - plane.origin, plane.normal)) <= allowed;
        if (flat)
            return plane;
    }
    return BoundingTree<3>(std::move(triangles));
}

Domain::Support Domain::support_of(std::vector<std::array<Vec3, 2>> segments) {
    const Vec3 origin = segments.front().front();
    Vec3 far;
    for (const auto &s : segments)
        for (const Vec3 &end : s)
            if (norm(end - origin) > norm(far))
                far = end - origin;
    if (norm(far) > 0.0) {
        const Line line{origin, (1.0 / norm(far)) * far};
        const double allowed = rounding(segments);
        bool straight = true;
        for (const auto &s : segments)
            for (const Vec3 &end : s) {
                const Vec3 d = end - origin;
                straight = straight && norm(d - dot(d, line.direction) * line.direction) <= allowed;
            }
        if (straight)
            return line;
    }
    return BoundingTree<2>(std::move(segments));
}

Vec3 Domain::retract(std::int32_t point, const Vec3 &x) {
    if (where(point) == kInterior)
        return x;
    std::int32_t &last = last_[static_cast<std::size_t>(point)];
    return std::visit(
        Overload{
            [&](const Plane &plane) { return x - dot(x - plane.origin, plane.normal) * plane.normal; },
            [&](const Line &line) { return line.origin + dot(x - line.origin, line.direction) * line.direction; },
            [&](const auto &tree) {
                const auto found = tree.closest(x, last);
                last = found.piece;
                return found.point;
            },
        },
        support(point));
}

Vec3 Domain::tangential(std::int32_t point, const Vec3 &x, const Vec3 &v) {
    if (where(point) == kInterior)
        return v;
    std::int32_t &last = last_[static_cast<std::size_t>(point)];
    return std::visit(Overload{
                          [&](const Plane &plane) { return v - dot(v, plane.normal) * plane.normal; },
                          [&](const Line &line) { return dot(v, line.direction) * line.direction; },
                          [&](const BoundingTree<3> &tree) {
                              last = tree.closest(x, last).piece;
                              const Vec3 n = normal_of(tree.pieces()[static_cast<std::size_t>(last)]);
                              return v - dot(v, n) * n;
                          },
                          [&](const BoundingTree<2> &tree) {
                              last = tree.closest(x, last).piece;
                              const Vec3 d = direction_of(tree.pieces()[static_cast<std::size_t>(last)]);
                              return dot(v, d) * d;
                          },
                      },
                      support(point));
}

} // namespace wct
