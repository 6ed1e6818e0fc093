#include "move_vertices/boundary_domain.h"

#include "geometry/edge_near_pieces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>

namespace wct::move_vertices {

namespace {

// Shares of the tolerance: what edges stay within all along, less than the whole because distance is a little larger
// the other way; and what the places that are looked at stay within, so that what is between them keeps to the former.
constexpr geometry::NearAlong kShares = {0.87, 0.95};

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

template <class... Functions> struct Overload : Functions... {
    using Functions::operator()...;
};

} // namespace

BoundaryDomain::BoundaryDomain(const Problem &problem, double tolerance)
    : where_(problem.points.size(), kFixed), last_(problem.points.size(), 0), tolerance_(tolerance),
      limit_(square(kShares.at * tolerance)), offsets_(problem.points.size() + 1, 0) {
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
        supports_.push_back(support_of(found->second));
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
    if (limit_ < std::numeric_limits<double>::infinity())
        watch(problem, patches, curves);
}

void BoundaryDomain::watch(const Problem &problem, std::map<std::int64_t, std::int32_t> &patches,
                           const std::map<std::int64_t, std::int32_t> &curves) {
    support_creases(problem, patches);
    std::set<std::array<std::int32_t, 3>> edges; // patch, ends
    Known known;
    for (std::size_t i = 0; i < problem.triangles.size(); ++i) {
        const auto &t = problem.triangles[i];
        if (!any_moves(t))
            continue;
        const std::int32_t support = patches.at(problem.triangle_patch[i]);
        if (!curved(support))
            continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
            if (any_moves(std::array{a, b}) && edges.insert({support, a, b}).second)
                add_watched({{a, b, -1}, support, false}, problem, known);
        }
        add_watched({t, support, true}, problem, known);
    }
    for (std::size_t i = 0; i < problem.segments.size(); ++i) {
        const auto &s = problem.segments[i];
        const auto found = curves.find(problem.segment_curve[i]);
        if (any_moves(s) && found != curves.end() && curved(found->second))
            add_watched({{s[0], s[1], -1}, found->second, true}, problem, known);
    }
    kept_ = covered_;
    list_watched();
}

bool BoundaryDomain::any_moves(std::span<const std::int32_t> corners) const {
    return std::any_of(corners.begin(), corners.end(), [this](std::int32_t corner) { return moves(corner); });
}

bool BoundaryDomain::curved(std::int32_t support) const {
    const Support &s = supports_[static_cast<std::size_t>(support)];
    return std::holds_alternative<geometry::PieceTree<3>>(s) || std::holds_alternative<geometry::PieceTree<2>>(s);
}

void BoundaryDomain::support_creases(const Problem &problem, std::map<std::int64_t, std::int32_t> &patches) {
    std::map<std::int64_t, std::vector<std::array<Vec3, 3>>> triangles;
    for (std::size_t i = 0; i < problem.triangles.size(); ++i)
        if (any_moves(problem.triangles[i]) && !patches.contains(problem.triangle_patch[i])) {
            if (triangles.empty())
                triangles = by_label(problem.points, problem.triangles, problem.triangle_patch);
            patches[problem.triangle_patch[i]] = static_cast<std::int32_t>(supports_.size());
            supports_.push_back(support_of(triangles[problem.triangle_patch[i]]));
        }
}

void BoundaryDomain::add_watched(const Watched &watched, const Problem &problem, Known &known) {
    watched_.push_back(watched);
    int &first = covered_.first.emplace_back(-1);
    for (const auto corner : watched.corners)
        if (watched.covers && corner >= 0 && known.insert({watched.support, corner}).second) {
            const auto owner = static_cast<std::int32_t>(watched_.size()) - 1;
            covered_.owners.own(covered_.owners.add(), owner, first);
            landmarks_.push_back(problem.points[static_cast<std::size_t>(corner)]);
        }
}

void BoundaryDomain::list_watched() {
    for (const Watched &w : watched_)
        for (const auto corner : w.corners)
            if (corner >= 0 && moves(corner))
                ++offsets_[static_cast<std::size_t>(corner) + 1];
    for (std::size_t p = 1; p < offsets_.size(); ++p)
        offsets_[p] += offsets_[p - 1];
    stars_.resize(offsets_.back());
    std::vector<std::size_t> next(offsets_.begin(), offsets_.end() - 1);
    for (std::size_t i = 0; i < watched_.size(); ++i)
        for (const auto corner : watched_[i].corners)
            if (corner >= 0 && moves(corner))
                stars_[next[static_cast<std::size_t>(corner)]++] = static_cast<std::int32_t>(i);
}

/// Is the middle of this facet, edge or segment near its patch or curve? What is not near is mostly not near there.
bool BoundaryDomain::middle_near(Watched &watched, std::span<const Vec3> points) const {
    const auto corner = [&](std::size_t i) -> const Vec3 & {
        return points[static_cast<std::size_t>(watched.corners[i])];
    };
    return sample_near(watched, 0,
                       watched.corners[2] < 0 ? 0.5 * (corner(0) + corner(1))
                                              : (1.0 / 3.0) * (corner(0) + corner(1) + corner(2)));
}

bool BoundaryDomain::sample_near(Watched &watched, std::size_t sample, const Vec3 &x) const {
    return std::visit(Overload{
                          [](const Plane &) { return true; },
                          [](const Line &) { return true; },
                          [&](const auto &tree) {
                              const std::int32_t piece = tree.within(x, limit_, watched.last[sample]);
                              if (piece >= 0)
                                  watched.last[sample] = piece;
                              return piece >= 0;
                          },
                      },
                      supports_[static_cast<std::size_t>(watched.support)]);
}

/// And the rest of it? Edges are checked all along, facets by samples inside: where surfaces lie side by side they are
/// farthest apart on an edge or at a landmark.
bool BoundaryDomain::rest_near(Watched &watched, std::span<const Vec3> points) const {
    const Vec3 &a = points[static_cast<std::size_t>(watched.corners[0])];
    const Vec3 &b = points[static_cast<std::size_t>(watched.corners[1])];
    if (watched.corners[2] < 0)
        return std::visit(
            Overload{
                [](const Plane &) { return true; },
                [](const Line &) { return true; },
                [&](const auto &tree) { return kShares.all_near(tree, a, b, tolerance_, watched.last[1]); },
            },
            supports_[static_cast<std::size_t>(watched.support)]);
    const Vec3 &c = points[static_cast<std::size_t>(watched.corners[2])];
    const Vec3 middle = (1.0 / 3.0) * (a + b + c);
    return sample_near(watched, 1, 0.5 * (a + middle)) && sample_near(watched, 2, 0.5 * (b + middle)) &&
           sample_near(watched, 3, 0.5 * (c + middle));
}

bool BoundaryDomain::covers(std::int32_t watched, const Vec3 &place, std::span<const Vec3> points) const {
    const Watched &w = watched_[static_cast<std::size_t>(watched)];
    const Vec3 &a = points[static_cast<std::size_t>(w.corners[0])];
    const Vec3 &b = points[static_cast<std::size_t>(w.corners[1])];
    const Vec3 foot =
        w.corners[2] < 0
            ? geometry::closest_on(std::array{a, b}, place)
            : geometry::closest_on(std::array{a, b, points[static_cast<std::size_t>(w.corners[2])]}, place);
    return dot(foot - place, foot - place) <= limit_;
}

/// What is near this place now that the point has moved: `first`, or something around its corners; or -1.
std::int32_t BoundaryDomain::cover(std::int32_t first, const Vec3 &place, std::int32_t point,
                                   std::span<const Vec3> points) const {
    if (covers(first, place, points))
        return first;
    const Watched &was = watched_[static_cast<std::size_t>(first)];
    const auto around = [&](std::int32_t corner) {
        for (const auto i : watched(corner)) {
            const Watched &w = watched_[static_cast<std::size_t>(i)];
            if (w.covers && w.support == was.support && covers(i, place, points))
                return i;
        }
        return std::int32_t{-1};
    };
    if (const std::int32_t found = around(point); found >= 0)
        return found;
    for (const auto corner : was.corners)
        if (corner >= 0 && corner != point)
            if (const std::int32_t found = around(corner); found >= 0)
                return found;
    return -1;
}

bool BoundaryDomain::admit(std::int32_t point, std::span<const Vec3> points) {
    const auto star = watched(point);
    for (const auto i : star)
        if (!middle_near(watched_[static_cast<std::size_t>(i)], points))
            return false;
    for (const auto i : star)
        if (!rest_near(watched_[static_cast<std::size_t>(i)], points))
            return false;
    handed_.clear();
    for (const auto i : star)
        for (int l = covered_.first[static_cast<std::size_t>(i)]; l >= 0; l = covered_.owners.next(l)) {
            const std::int32_t to = cover(i, landmarks_[static_cast<std::size_t>(l)], point, points);
            if (to < 0)
                return false;
            if (to != i)
                handed_.push_back({l, to});
        }
    for (const auto &[l, to] : handed_) {
        covered_.owners.disown(l, covered_.first[static_cast<std::size_t>(covered_.owners.owner(l))]);
        covered_.owners.own(l, to, covered_.first[static_cast<std::size_t>(to)]);
    }
    return true;
}

BoundaryDomain::Support BoundaryDomain::support_of(std::vector<std::array<Vec3, 3>> triangles) {
    // The normal of the sum of all triangles, each turned to the side of the largest: small ones have poor normals.
    Vec3 largest;
    for (const auto &t : triangles) {
        const Vec3 n = normal_of(t);
        if (dot(n, n) > dot(largest, largest))
            largest = n;
    }
    Vec3 sum;
    for (const auto &t : triangles) {
        const Vec3 n = normal_of(t);
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
    return geometry::PieceTree<3>(std::move(triangles));
}

BoundaryDomain::Support BoundaryDomain::support_of(std::vector<std::array<Vec3, 2>> segments) {
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
    return geometry::PieceTree<2>(std::move(segments));
}

Vec3 BoundaryDomain::retract(std::int32_t point, const Vec3 &x) {
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

Vec3 BoundaryDomain::tangential(std::int32_t point, const Vec3 &x, const Vec3 &v) {
    if (where(point) == kInterior)
        return v;
    std::int32_t &last = last_[static_cast<std::size_t>(point)];
    return std::visit(Overload{
                          [&](const Plane &plane) { return v - dot(v, plane.normal) * plane.normal; },
                          [&](const Line &line) { return dot(v, line.direction) * line.direction; },
                          [&](const geometry::PieceTree<3> &tree) {
                              last = tree.closest(x, last).piece;
                              const Vec3 n = unit(normal_of(tree.pieces()[static_cast<std::size_t>(last)]));
                              return v - dot(v, n) * n;
                          },
                          [&](const geometry::PieceTree<2> &tree) {
                              last = tree.closest(x, last).piece;
                              const auto &[a, b] = tree.pieces()[static_cast<std::size_t>(last)];
                              const Vec3 d = unit(b - a);
                              return dot(v, d) * d;
                          },
                      },
                      support(point));
}

} // namespace wct::move_vertices
