#include "search/surface_guide.h"

#include "geometry/box_tree.h"
#include "geometry/edge_near_pieces.h"
#include "geometry/kept_extent.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

namespace wct::search {

namespace {
// Shares of the tolerance. Vertices of curved patches stay in a shell; edges are held all along, so they get nearly all
// of it; the inside of facets is held at a few points only.
constexpr double kShell = 0.97;
constexpr double kTube = 0.5;
/// Of creases beside a plane, in it: chords of a rim keep its area where their ends stand out.
constexpr double kRim = 0.9;
/// The same where the plane goes on to nothing but parts a curved side, as an interface: no more, as vertices that all
/// stand out so far, with chords as far in, leave its area no way back.
constexpr double kParting = 0.7;
constexpr geometry::NearAlong kAlong = {0.975, 0.985};
constexpr double kInside = 0.93;
/// Cosine of the greatest angle between a facet and the surface at its middle.
constexpr double kTurned = 0.6;
/// Landmarks are put on edges that bend by more than this: cosine of 2 degrees.
constexpr double kBend = 0.99939;
/// They are no farther apart than this share of the tolerance over the sine of half the bend, but no more than kParts
/// to an edge.
constexpr double kApart = 0.3;
constexpr int kParts = 1024;

/// Where a facet is held against the surface: its centroid, half-way from there to the corners, and, only to measure
/// how far it is, the middles of its edges.
constexpr int kSamples = 7;
constexpr int kInner = 4;
constexpr double kWeights[kSamples][3] = {{1. / 3, 1. / 3, 1. / 3},
                                          {.666, .167, .167},
                                          {.167, .666, .167},
                                          {.167, .167, .666},
                                          {.5, .5, 0},
                                          {0, .5, .5},
                                          {.5, 0, .5}};

Vec3 blend(const double weights[3], const std::array<Vec3, 3> &c) {
    return weights[0] * c[0] + weights[1] * c[1] + weights[2] * c[2];
}

/// Draw x towards the foot until it is no farther than `reach` from it.
void pull_to(const Vec3 &foot, double reach, Vec3 &x) {
    const Vec3 off = x - foot;
    const double length = norm(off);
    if (length > reach)
        x = foot + (reach / length) * off;
}

/// The closest point of a patch or curve; none, and `hint` at a piece so near, where the way downhill comes within
/// `surely(piece)` of x.
template <class Tree, class Surely>
std::optional<Vec3> foot_beyond(const Tree &tree, const Surely &surely, const Vec3 &x, std::int32_t &hint) {
    const auto near = tree.downhill(x, square(surely(hint)), hint);
    hint = near.piece;
    if (near.square <= square(surely(hint)))
        return std::nullopt;
    const auto found = tree.closest(x, hint);
    hint = found.piece;
    return found.point;
}

/// Draw x towards a curve until it is no farther than `reach` from it.
void clamp(const geometry::PieceTree<2> &curve, double reach, Vec3 &x, std::int32_t &hint) {
    if (const auto foot = foot_beyond(curve, [reach](std::int32_t) { return reach; }, x, hint))
        pull_to(*foot, reach, x);
}

/// The least tolerance at the corners of these segments or triangles.
template <class Cells> double least_of(const SurfaceGuide::Surface &surface, const Cells &cells, double tolerance) {
    for (const auto &cell : cells)
        for (const int v : cell)
            if (!surface.local.empty())
                tolerance = std::min(tolerance, surface.local[v]);
    return tolerance;
}

/// The greatest angle that segments of a curve turn by where they meet, up to a right one.
double greatest_turn(const std::vector<Vec3> &points, const std::vector<Edge> &segments) {
    double turn = 0.0;
    std::map<int, Vec3> leaving; // unit vector from a point along its first segment
    for (const Edge &s : segments)
        for (int k = 0; k < 2; ++k) {
            const Vec3 way = unit(points[s[1 - k]] - points[s[k]]);
            if (const auto [at, first] = leaving.try_emplace(s[k], way); !first)
                turn = std::max(turn, angle(at->second, -1.0 * way));
        }
    return std::min(turn, 0.5 * std::numbers::pi);
}

/// The least tolerance at the corners of each piece of a tree over these triangles, which orders them in its own way.
std::vector<double> of_pieces(const SurfaceGuide::Surface &surface, const std::vector<Facet> &members,
                              const std::vector<std::array<Vec3, 3>> &pieces) {
    const auto key = [](const Vec3 &p) { return std::array{p.x, p.y, p.z}; };
    std::map<std::array<double, 3>, double> at; // points in one place: the least of them
    for (const Facet &f : members)
        for (const int v : f) {
            const auto [found, first] = at.try_emplace(key(surface.points[v]), surface.local[v]);
            found->second = std::min(found->second, surface.local[v]);
        }
    std::vector<double> local;
    for (const auto &[a, b, c] : pieces)
        local.push_back(std::min({at.at(key(a)), at.at(key(b)), at.at(key(c))}));
    return local;
}

} // namespace

SurfaceGuide::SurfaceGuide(const Surface &surface, double tolerance, double spacing) : tolerance_(tolerance) {
    geometry::Box box;
    for (const Vec3 &p : surface.points)
        box.add(p);
    diagonal_ = box.diagonal();
    make_patches(surface);
    make_curves(surface);
    make_corners(surface);
    make_landmarks(surface, spacing);
}

void SurfaceGuide::make_patches(const Surface &surface) {
    const auto &[points, triangles, patch, segments, curve, flat, local] = surface;
    const int patches = patch.empty() ? 0 : *std::max_element(patch.begin(), patch.end()) + 1;
    std::vector<std::vector<Facet>> of_patch(patches);
    for (std::size_t k = 0; k < triangles.size(); ++k)
        of_patch[patch[k]].push_back(triangles[k]);
    for (const auto &members : of_patch) {
        std::vector<std::array<Vec3, 3>> pieces;
        for (const Facet &f : members)
            pieces.push_back({points[f[0]], points[f[1]], points[f[2]]});
        Patch one{geometry::PieceTree<3>(std::move(pieces)), false, {}, 0.0, {}, {}};
        for (const Facet &f : members)
            one.area += 0.5 * norm(normal_of({points[f[0]], points[f[1]], points[f[2]]}));
        const double least = least_of(surface, members, tolerance_);
        if (least < tolerance_) {
            one.local = of_pieces(surface, members, one.tree.pieces());
            one.surely = one.tree.least_around(one.local, 2.0 * tolerance_);
        }
        const auto [plane, extent, off] = geometry::plane_of(points, members);
        one.plane = plane;
        one.planar = extent > geometry::kept_extent(diagonal_, least) && geometry::is_flat(off, extent, flat);
        patches_.push_back(std::move(one));
    }
}

void SurfaceGuide::make_curves(const Surface &surface) {
    const auto &[points, triangles, patch, segments, curve, flat, local] = surface;
    const int curves = curve.empty() ? 0 : *std::max_element(curve.begin(), curve.end()) + 1;
    std::map<Edge, std::set<int>> planes; // planar patches at each edge
    std::map<Edge, int> curved;           // facets of the others at each edge
    for (std::size_t k = 0; k < triangles.size(); ++k)
        for (int i = 0; i < 3; ++i) {
            const Edge edge = sorted(triangles[k][i], triangles[k][(i + 1) % 3]);
            if (patches_[patch[k]].planar)
                planes[edge].insert(patch[k]);
            else
                ++curved[edge];
        }
    std::vector<std::vector<Edge>> of_curve(curves);
    for (std::size_t k = 0; k < segments.size(); ++k)
        of_curve[curve[k]].push_back(segments[k]);
    for (const auto &members : of_curve) {
        std::vector<std::array<Vec3, 2>> pieces;
        for (const Edge &s : members)
            pieces.push_back({points[s[0]], points[s[1]]});
        Curve one{geometry::PieceTree<2>(std::move(pieces)), false, false, false, {}, {}, {}, 0.0};
        one.tolerance = least_of(surface, members, tolerance_);
        Vec3 far = {};
        double extent = 0.0, off = 0.0;
        if (!members.empty())
            one.origin = points[members[0][0]];
        for (const Edge &s : members)
            for (int v : s)
                if (norm(points[v] - one.origin) > extent) {
                    far = points[v] - one.origin;
                    extent = norm(far);
                }
        one.direction = unit(far);
        for (const Edge &s : members)
            for (int v : s)
                off = std::max(off, norm(cross(points[v] - one.origin, one.direction)));
        std::set<int> shared = members.empty() ? std::set<int>{} : planes[sorted(members[0][0], members[0][1])];
        for (const Edge &s : members)
            std::erase_if(shared, [&](int p) { return !planes[sorted(s[0], s[1])].contains(p); });
        // Where two planes are kept, so is their line.
        one.straight = (extent > geometry::kept_extent(diagonal_, one.tolerance) || shared.size() > 1) &&
                       geometry::is_flat(off, extent, flat);
        one.bare = !one.straight && std::none_of(members.begin(), members.end(),
                                                 [&](const Edge &s) { return curved.contains(sorted(s[0], s[1])); });
        if (one.bare) // its corners are off an edge that cuts across them by more than the edge is off the curve
            one.tolerance *= std::cos(0.5 * greatest_turn(points, members));
        one.parting = !members.empty() && std::all_of(members.begin(), members.end(), [&](const Edge &s) {
            const auto at = curved.find(sorted(s[0], s[1]));
            return at != curved.end() && at->second > 1;
        });
        if (!shared.empty()) // a curved line has one plane
            one.plane = patches_[*shared.begin()].plane;
        curves_.push_back(std::move(one));
    }
}

void SurfaceGuide::make_corners(const Surface &surface) {
    for (const Edge &s : surface.segments)
        for (int v : s)
            if (corners_.emplace(v, surface.points[v]).second && !surface.local.empty())
                at_corners_.emplace(v, surface.local[v]);
    for (std::size_t k = 0; k < surface.segments.size(); ++k)
        if (curves_[surface.curve[k]].straight)
            for (int v : surface.segments[k])
                corners_.erase(v);
    for (std::size_t k = 0; k < surface.triangles.size(); ++k)
        if (patches_[surface.patch[k]].planar)
            for (int v : surface.triangles[k])
                corners_.erase(v);
}

void SurfaceGuide::make_landmarks(const Surface &surface, double spacing) {
    const auto &[points, triangles, patch, segments, curve, flat, local] = surface;
    std::set<std::array<int, 2>> seen; // patch and vertex
    // By patch and edge: of the triangle seen first, as if it ran along the edge from the smaller end to the other.
    std::map<std::array<int, 3>, Vec3> normals;
    for (std::size_t k = 0; k < triangles.size(); ++k) {
        if (patches_[patch[k]].planar)
            continue;
        const Facet &t = triangles[k];
        const Vec3 normal = unit(normal_of({points[t[0]], points[t[1]], points[t[2]]}));
        for (int i = 0; i < 3; ++i) {
            if (seen.insert({patch[k], t[i]}).second)
                landmarks_.push_back({points[t[i]], patch[k], false, local.empty() ? tolerance_ : local[t[i]]});
            const Edge edge = sorted(t[i], t[(i + 1) % 3]);
            const Vec3 along = t[i] == edge[0] ? normal : -1.0 * normal;
            const auto [found, first] = normals.try_emplace({patch[k], edge[0], edge[1]}, along);
            const double bend = -dot(found->second, along); // its cosine: what follows it runs the other way
            if (first || bend > kBend)
                continue;
            // The sharper the bend, the faster the distance may grow between landmarks.
            const double tolerance = local.empty() ? tolerance_ : std::min(local[edge[0]], local[edge[1]]);
            const double apart = std::min(spacing, kApart * tolerance / std::sqrt(0.5 * (1.0 - bend)));
            const Vec3 &a = points[edge[0]], &b = points[edge[1]];
            const int parts = std::min(kParts, static_cast<int>(std::ceil(norm(b - a) / apart)));
            for (int p = 1; p < parts; ++p)
                landmarks_.push_back(
                    {a + (static_cast<double>(p) / parts) * (b - a), patch[k], p + 1 < parts, tolerance});
        }
    }
}

Freedom SurfaceGuide::admit_on(const Patch &patch, Vec3 &x, std::int32_t &hint) const {
    if (patch.planar) {
        x = patch.plane.nearest(x);
        return {Freedom::Kind::plane, patch.plane.normal()};
    }
    const auto surely = [&](std::int32_t piece) { return kShell * surely_at(patch, piece); };
    if (const auto foot = foot_beyond(patch.tree, surely, x, hint))
        pull_to(*foot, kShell * tolerance_at(patch, hint), x);
    return {};
}

Freedom SurfaceGuide::admit_on(const Curve &curve, Vec3 &x, std::int32_t &hint) const {
    if (curve.straight) {
        x = curve.origin + dot(x - curve.origin, curve.direction) * curve.direction;
        return {Freedom::Kind::line, curve.direction};
    }
    if (!curve.plane) {
        clamp(curve.tree, kTube * curve.tolerance, x, hint);
        return {};
    }
    x = curve.plane->nearest(x);
    clamp(curve.tree, (curve.parting ? kParting : kRim) * curve.tolerance, x, hint);
    return {Freedom::Kind::plane, curve.plane->normal()};
}

Freedom SurfaceGuide::admit(const Vertex &vertex, Vec3 &x, std::int32_t &hint) const {
    switch (vertex.stratum) {
    case Stratum::patch:
        return admit_on(patches_[vertex.label], x, hint);
    case Stratum::crease:
        return admit_on(curves_[vertex.label], x, hint);
    case Stratum::corner: {
        const auto own = at_corners_.find(vertex.label);
        pull_to(corners_.at(vertex.label), kTube * (own == at_corners_.end() ? tolerance_ : own->second), x);
        break;
    }
    case Stratum::interior:
        break;
    }
    return {};
}

bool SurfaceGuide::sample_near(const Patch &patch, const Vec3 &x, std::int32_t &hint, double &least) const {
    if (patch.local.empty()) {
        const std::int32_t found = patch.tree.within(x, square(kInside * tolerance_), hint);
        if (found >= 0)
            hint = found;
        return found >= 0;
    }
    const auto surely = [&](std::int32_t piece) { return kInside * patch.surely[piece]; };
    const auto foot = foot_beyond(patch.tree, surely, x, hint);
    least = std::min(least, patch.local[hint]);
    return !foot || dot(x - *foot, x - *foot) <= square(kInside * patch.local[hint]);
}

bool SurfaceGuide::near(int patch, const std::array<Vec3, 3> &corners, unsigned edges, SurfaceHints &hints) const {
    const Patch &on = patches_[patch];
    double least = tolerance_; // of the samples so far
    const auto is_near = [&](int k) { return sample_near(on, blend(kWeights[k], corners), hints[k], least); };
    if (!is_near(0))
        return false;
    const Vec3 n = normal_of(corners);
    const Vec3 m = normal_of(on.tree.pieces()[hints[0]]);
    if (std::abs(dot(n, m)) < kTurned * norm(n) * norm(m))
        return false;
    // What is not near is mostly not near in the middle of an edge, or else inside; the whole length comes last.
    for (int k = 0; k < 3; ++k)
        if (edges >> k & 1u && !is_near(kInner + k))
            return false;
    for (int k = 1; k < kInner; ++k)
        if (!is_near(k))
            return false;
    for (int k = 0; k < 3; ++k)
        if (edges >> k & 1u && !kAlong.all_near(on.tree, corners[k], corners[(k + 1) % 3], least, hints[kSamples + k]))
            return false;
    return true;
}

SurfaceGuide::Gap SurfaceGuide::gap(int patch, const std::array<Vec3, 3> &corners, SurfaceHints &hints,
                                    double enough) const {
    const Patch &on = patches_[patch];
    Gap worst;
    for (int k = 0; k < kSamples && worst.distance <= enough; ++k) {
        const auto &weights = kWeights[k];
        const Vec3 x = blend(weights, corners);
        const double within =
            on.local.empty() ? worst.distance : std::min(worst.distance * on.surely[hints[k]] / tolerance_, tolerance_);
        if (within > 0.0 && on.tree.reaches(hints[k], x, square(within)))
            continue; // no farther than another is
        const auto found = on.tree.closest(x, hints[k]);
        hints[k] = found.piece;
        const Vec3 to = found.point - x;
        const double strict = tolerance_ / tolerance_at(on, found.piece);
        if (strict * norm(to) > worst.distance)
            worst = {strict * norm(to), {weights[0], weights[1], weights[2]}, to, strict};
    }
    return worst;
}

double SurfaceGuide::offset(int patch, const std::array<Vec3, 3> &corners, const SurfaceHints &hints) const {
    // The middles of the edges: exact where the distance is quadratic over the facet, as it is over a smooth surface.
    double sum = 0.0;
    for (int k = kInner; k < kSamples; ++k)
        sum += height(patch, blend(kWeights[k], corners), hints[k]);
    return sum / (kSamples - kInner);
}

double SurfaceGuide::height(int patch, const Vec3 &x, std::int32_t guess) const {
    const geometry::PieceTree<3> &tree = patches_[patch].tree;
    const auto found = tree.closest(x, guess);
    const Vec3 off = x - found.point;
    return dot(off, normal_of(tree.pieces()[found.piece])) < 0.0 ? -norm(off) : norm(off);
}

Vec3 SurfaceGuide::normal(int patch, const Vec3 &x, std::int32_t guess) const {
    return normal(patch, patches_[patch].tree.closest(x, guess).piece);
}

bool SurfaceGuide::allows_crease(int curve, const Vec3 &p, const Vec3 &q) const {
    const Curve &guide = curves_[curve];
    if (guide.straight)
        return true;
    // It is looked at from one end, and that may tell in the last places.
    const bool from_p = std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
    std::int32_t first = 0;
    return kAlong.all_near(guide.tree, from_p ? p : q, from_p ? q : p, guide.tolerance, first);
}

double SurfaceGuide::crease_gap(int curve, const Vec3 &p, const Vec3 &q) const {
    constexpr int parts = 16;
    double most = 0.0;
    std::int32_t hint = 0;
    for (int k = 0; k <= parts; ++k) {
        const Vec3 x = p + (static_cast<double>(k) / parts) * (q - p);
        const auto found = curves_[curve].tree.closest(x, hint);
        hint = found.piece;
        most = std::max(most, norm(x - found.point));
    }
    return most;
}

} // namespace wct::search
