#include "domain/reference.h"

#include "base/disjoint_sets.h"
#include "geometry/kept_extent.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

namespace wct::domain {

namespace {

geometry::Box box_of(const SurfaceData &data, int triangle) {
    geometry::Box box;
    for (const int v : data.triangles[triangle])
        box.add(data.points[v]);
    return box;
}

/// The shape operator S at a wedge, as the least-squares solution of dN = S dX over the edges round it.
struct ShapeSums {
    double xx = 0.0, xy = 0.0, yy = 0.0, xa = 0.0, ya = 0.0, xb = 0.0, yb = 0.0;

    /// An edge (x, y) in the tangent plane along which the normal changes by (a, b).
    void add(double x, double y, double a, double b) {
        xx += x * x;
        xy += x * y;
        yy += y * y;
        xa += x * a;
        ya += y * a;
        xb += x * b;
        yb += y * b;
    }

    /// The eigenvalues of S, the larger first; zero without edges.
    std::array<double, 2> curvatures() const {
        constexpr double damping = 1e-9; // relative: where all edges run one way, nothing bends across them
        const double trace = xx + yy;
        if (!(trace > 0.0))
            return {0.0, 0.0};
        // Unknowns A, B, C of S = [[A, B], [B, C]]: normal equations of a = A x + B y, b = B x + C y.
        const double ridge = damping * trace;
        const double p = xx + ridge;
        const double q = xx + yy + ridge;
        const double r = yy + ridge;
        const double rhs = ya + xb;
        // Eliminate A = (xa - xy B) / p and C = (yb - xy B) / r.
        const double b = (rhs - xy * xa / p - xy * yb / r) / (q - xy * xy / p - xy * xy / r + ridge);
        const double a = (xa - xy * b) / p;
        const double c = (yb - xy * b) / r;
        const double mean = 0.5 * (a + c);
        const double spread = std::hypot(0.5 * (a - c), b);
        return {mean + spread, mean - spread};
    }
};

} // namespace

Vec3 across(const Vec3 &n) {
    constexpr double small = 0.6; // above 1 / sqrt(3): some component is smaller
    const Vec3 axis = std::fabs(n.x) < small ? Vec3{1, 0, 0} : std::fabs(n.y) < small ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
    return unit(cross(n, axis));
}

Reference::Reference(SurfaceData data) : data_(std::move(data)) {
    geometry::Box all;
    std::vector<geometry::Box> boxes;
    boxes.reserve(data_.triangles.size());
    for (std::size_t t = 0; t < data_.triangles.size(); ++t) {
        boxes.push_back(box_of(data_, static_cast<int>(t)));
        all.add(boxes.back());
    }
    diagonal_ = all.diagonal();
    for (const Vec3 &p : {all.lo, all.hi})
        scale_ = std::max({scale_, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    tree_ = geometry::BoxTree(boxes);
    patch_trees_.resize(data_.sides.size());
    for (std::size_t t = 0; t < data_.triangles.size(); ++t)
        patch_trees_[data_.patch[t]].triangles.push_back(static_cast<int>(t));
    for (auto &part : patch_trees_) {
        if (patch_trees_.size() == 1)
            break; // tree_ is that of the only patch
        std::vector<geometry::Box> own;
        for (const int t : part.triangles)
            own.push_back(boxes[t]);
        part.tree = geometry::BoxTree(own);
    }
    make_wedges();
    make_normals();
    find_planes();
    make_curvatures();
    make_curves();
    offset.assign(wedge_vertex_.size(), 0.0);
}

void Reference::make_wedges() {
    // Triangles round a vertex are of one wedge if they are joined across edges of their patch: a crease that fades out
    // on a patch has the patch on both of its sides, and two wedges per vertex.
    std::set<Edge> creases;
    for (const auto *edges : {&data_.segments, &data_.folds})
        for (const auto &[v, w] : *edges)
            creases.insert(sorted(v, w));
    struct Side {
        std::array<int, 3> key;     // ends, patch
        std::array<int, 2> corners; // of a triangle, at the ends
    };
    std::vector<Side> sides;
    sides.reserve(3 * data_.triangles.size());
    for (std::size_t t = 0; t < data_.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
            const int next = (k + 1) % 3, v = data_.triangles[t][k], w = data_.triangles[t][next];
            const int corner = static_cast<int>(3 * t);
            if (creases.contains(sorted(v, w)))
                continue;
            v < w ? sides.push_back({{v, w, data_.patch[t]}, {corner + k, corner + next}})
                  : sides.push_back({{w, v, data_.patch[t]}, {corner + next, corner + k}});
        }
    std::sort(sides.begin(), sides.end(),
              [](const Side &a, const Side &b) { return std::tie(a.key, a.corners) < std::tie(b.key, b.corners); });
    DisjointSets fans(3 * data_.triangles.size()); // of corners
    for (std::size_t k = 1; k < sides.size(); ++k)
        for (int end = 0; end < 2 && sides[k].key == sides[k - 1].key; ++end)
            fans.join(sides[k].corners[end], sides[k - 1].corners[end]);
    std::vector<int> wedges(3 * data_.triangles.size(), -1); // of each fan, at its root
    wedges_.reserve(data_.triangles.size());
    for (std::size_t t = 0; t < data_.triangles.size(); ++t) {
        std::array<int, 3> own;
        for (int k = 0; k < 3; ++k) {
            int &wedge = wedges[fans.find(static_cast<int>(3 * t) + k)];
            if (wedge < 0) {
                wedge = static_cast<int>(wedge_vertex_.size());
                wedge_vertex_.push_back(data_.triangles[t][k]);
            }
            own[k] = wedge;
        }
        wedges_.push_back(own);
    }
}

void Reference::make_normals() {
    const auto &points = data_.points;
    const auto &triangles = data_.triangles;
    wedge_normal_.assign(wedge_vertex_.size(), {});
    vertex_normal_.assign(points.size(), {});
    struct Side {
        std::array<int, 2> ends;
        int triangle, opposite;
    };
    std::vector<Side> sides;
    sides.reserve(3 * triangles.size());
    areas_.reserve(triangles.size());
    normals_.reserve(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const auto &[a, b, c] = triangles[t];
        const Vec3 n = cross(points[b] - points[a], points[c] - points[a]);
        areas_.push_back(0.5 * norm(n));
        normals_.push_back(unit(n));
        for (int k = 0; k < 3; ++k) {
            const int v = triangles[t][k];
            const int w = triangles[t][(k + 1) % 3];
            const Vec3 p = points[w] - points[v];
            const Vec3 q = points[triangles[t][(k + 2) % 3]] - points[v];
            const double pq = dot(p, p) * dot(q, q);
            if (pq > 0.0) {
                // Max's weights: the normal is exact where all vertices around lie on a sphere.
                wedge_normal_[wedges_[t][k]] += (norm(cross(p, q)) / pq) * normals_.back();
                vertex_normal_[v] += angle(p, q) * normals_.back();
            }
            sides.push_back({sorted(v, w), static_cast<int>(t), (k + 2) % 3});
        }
    }
    for (auto &n : wedge_normal_)
        n = unit(n);
    std::sort(sides.begin(), sides.end(), [](const Side &a, const Side &b) {
        return std::tie(a.ends, a.triangle, a.opposite) < std::tie(b.ends, b.triangle, b.opposite);
    });
    edge_normal_.resize(triangles.size());
    for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
        Vec3 sum;
        for (last = first; last < sides.size() && sides[last].ends == sides[first].ends; ++last)
            sum += normals_[sides[last].triangle];
        for (std::size_t k = first; k < last; ++k)
            edge_normal_[sides[k].triangle][sides[k].opposite] = last - first == 2 ? sum : normals_[sides[k].triangle];
    }
}

void Reference::find_planes() {
    planar_.assign(patch_trees_.size(), 0);
    plane_.resize(patch_trees_.size());
    for (std::size_t p = 0; p < patch_trees_.size(); ++p) {
        std::vector<std::array<int, 3>> own;
        for (const int t : patch_trees_[p].triangles)
            own.push_back(data_.triangles[t]);
        const auto [plane, extent, off] = geometry::plane_of(data_.points, own);
        plane_[p] = plane;
        planar_[p] = extent > 0.0 && geometry::is_flat(off, extent, data_.flat);
    }
}

bool Reference::has_inner() const {
    for (int patch = 0; patch < patches(); ++patch)
        if (inner(patch))
            return true;
    return false;
}

bool Reference::keeps(int patch, double tolerance) const {
    constexpr std::size_t root = 0;
    return planar_[patch] &&
           patch_trees_[patch].tree.box(root).diagonal() > geometry::kept_extent(diagonal_, tolerance);
}

template <class Visit> void Reference::along_edges(const Visit &visit) const {
    for (std::size_t t = 0; t < wedges_.size(); ++t)
        for (int k = 0; k < 3 && !planar_[data_.patch[t]]; ++k) {
            visit(wedges_[t][k], wedges_[t][(k + 1) % 3]);
            visit(wedges_[t][(k + 1) % 3], wedges_[t][k]);
        }
}

void Reference::make_curvatures() {
    const std::size_t count = wedge_vertex_.size();
    std::vector<ShapeSums> sums(count);
    std::vector<Vec3> first(count);
    for (std::size_t w = 0; w < count; ++w)
        first[w] = across(wedge_normal_[w]);
    along_edges([&](int v, int w) {
        const Vec3 d = data_.points[wedge_vertex_[w]] - data_.points[wedge_vertex_[v]];
        const Vec3 dn = wedge_normal_[w] - wedge_normal_[v];
        const Vec3 second = cross(wedge_normal_[v], first[v]);
        sums[v].add(dot(d, first[v]), dot(d, second), dot(dn, first[v]), dot(dn, second));
    });
    curvatures_.resize(count);
    for (std::size_t w = 0; w < count; ++w)
        curvatures_[w] = sums[w].curvatures();
    constexpr int passes = 2; // means with the neighbours'
    for (int pass = 0; pass < passes; ++pass)
        smooth_curvatures();
    for (auto &k : curvatures_)
        if (std::fabs(k[1]) > std::fabs(k[0]))
            std::swap(k[0], k[1]);
}

void Reference::smooth_curvatures() {
    auto sum = curvatures_;
    std::vector<double> weight(sum.size(), 1.0);
    along_edges([&](int v, int w) {
        sum[v][0] += curvatures_[w][0];
        sum[v][1] += curvatures_[w][1];
        weight[v] += 1.0;
    });
    for (std::size_t w = 0; w < sum.size(); ++w)
        curvatures_[w] = {sum[w][0] / weight[w], sum[w][1] / weight[w]};
}

void Reference::try_triangle(const Vec3 &p, int triangle, double &square, Foot &foot) const {
    const auto &[a, b, c] = data_.triangles[triangle];
    const geometry::TrianglePoint at =
        geometry::nearest_on_triangle(p, data_.points[a], data_.points[b], data_.points[c]);
    if (!(at.square < square))
        return;
    square = at.square;
    foot.point = at.point;
    foot.triangle = triangle;
    std::copy(at.weight, at.weight + 3, foot.weight);
}

Foot Reference::nearest(const Vec3 &p, int patch, int hint) const {
    Foot foot;
    const PatchTree *part = patch < 0 || patch_trees_.size() == 1 ? nullptr : &patch_trees_[patch];
    const geometry::BoxTree &tree = part ? part->tree : tree_;
    double most = std::numeric_limits<double>::infinity();
    if (hint >= 0 && (!part || data_.patch[hint] == patch)) {
        try_triangle(p, hint, most, foot);
        most = geometry::with_room(most, scale_);
        foot = {};
    }
    const double square = tree.minimise(
        most, [&](std::size_t node) { return tree.box(node).square(p); },
        [&](std::size_t item, double best) {
            try_triangle(p, part ? part->triangles[item] : static_cast<int>(item), best, foot);
            return best;
        });
    foot.distance = std::sqrt(square);
    return foot;
}

double Reference::ray(const Vec3 &p, const Vec3 &direction, double least, double most, int &triangle) const {
    const Vec3 inverse = geometry::inverse_of(direction);
    triangle = -1;
    return tree_.minimise(
        most, [&](std::size_t node) { return geometry::ray_box(p, inverse, tree_.box(node)); },
        [&](std::size_t t, double best) {
            const auto &[a, b, c] = data_.triangles[t];
            const double at =
                geometry::ray_triangle(p, direction, least, data_.points[a], data_.points[b], data_.points[c]);
            if (at < best)
                triangle = static_cast<int>(t);
            return at;
        });
}

Vec3 Reference::away(int triangle, const Edge &edge, const Vec3 &along) const {
    for (const int v : data_.triangles[triangle])
        if (v != edge[0] && v != edge[1]) {
            const Vec3 d = data_.points[v] - data_.points[edge[0]];
            return unit(d - dot(d, along) * along);
        }
    return {};
}

Vec3 Reference::smooth_normal(const Foot &foot) const {
    const int patch = data_.patch[foot.triangle];
    if (planar_[patch])
        return plane_[patch].normal();
    Vec3 n;
    for (int k = 0; k < 3; ++k)
        n += foot.weight[k] * wedge_normal_[wedges_[foot.triangle][k]];
    return dot(n, n) > 0.0 ? unit(n) : normals_[foot.triangle];
}

double Reference::height(const Vec3 &p, const Foot &foot) const {
    // At an edge or vertex the sign comes from the pseudonormal (Baerentzen and Aanaes, "Signed Distance Computation
    // Using the Angle Weighted Pseudonormal").
    constexpr double kTouch = 1e-9;
    int zeros = 0;
    int zero = 0;
    int one = 0;
    for (int k = 0; k < 3; ++k)
        if (foot.weight[k] <= kTouch) {
            ++zeros;
            zero = k;
        } else {
            one = k;
        }
    const Vec3 &n = zeros == 0   ? normals_[foot.triangle]
                    : zeros == 1 ? edge_normal_[foot.triangle][zero]
                                 : vertex_normal_[data_.triangles[foot.triangle][one]];
    return dot(p - foot.point, n) > 0.0 ? foot.distance : -foot.distance;
}

int Reference::region_beside(const Vec3 &p, const Foot &foot) const {
    return data_.sides[data_.patch[foot.triangle]][height(p, foot) > 0.0 ? 1 : 0];
}

Vec3 Reference::to_patch(Vec3 &p, const Foot &foot) const {
    const int patch = data_.patch[foot.triangle];
    if (planar_[patch]) {
        p = plane_[patch].nearest(foot.point);
        return plane_[patch].normal();
    }
    const Vec3 n = smooth_normal(foot);
    double shift = 0.0;
    for (int k = 0; k < 3; ++k)
        shift += foot.weight[k] * offset[wedges_[foot.triangle][k]];
    p = foot.point + shift * n;
    return n;
}

} // namespace wct::domain
