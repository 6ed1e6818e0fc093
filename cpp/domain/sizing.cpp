#include "domain/sizing.h"

#include "domain/limit_gradient.h"
#include "domain/passing_creases.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace wct::domain {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// A crease across a layer has two edges: with one, the tet at either end is the one with three right angles, which no
/// point near there would divide.
constexpr double kAcross = 1.2; // greatest length of such a crease, in thicknesses
constexpr double kHalf = 0.6;   // size per length of it
/// Edges beside a crease that passes, in distances: in the body-centred lattice opposite edges are as far apart as half
/// the longer of its edges is long.
constexpr double kPassing = 1.5;

} // namespace

double unit_sag(double k1, double k2) {
    const double a = std::fabs(k1);
    const double b = std::fabs(k2);
    return k1 * k2 > 0.0 ? std::max(a, b) / 8.0 + std::min(a, b) / 24.0 : (a + b) / 8.0;
}

Sizing::Sizing(const Reference &reference, const InputMesh &mesh, const RegionMap &map, const SizingForm &form,
               std::span<const double> wanted, const Workers &workers)
    : reference_(reference), mesh_(mesh), map_(map), form_(form), sharp_(reference), notches_(reference, true) {
    make_input_sizes(wanted);
    const auto &points = reference.data().points;
    limit_.resize(points.size());
    workers.for_each(points.size(), 512, [&](std::size_t v) { limit_[v] = form.coarsen * input_size(points[v]); });
    limit_by_wires();
    limit_by_places(); // not of the surface's own sizes, which grow slower with the distance and over large triangles
    limit_by_curvature();
    limit_by_thickness(workers);
    surface = limit_;
    for (std::size_t v = 0; v < form.most.size(); ++v)
        surface[v] = std::min(surface[v], form.most[v]);
    for (std::size_t v = 0; v < surface.size(); ++v)
        surface[v] = std::min(surface[v], curved_[v]);
    limit_by_bends();
    limit_by_creases();
    limit_by_passing_creases();
    if (form.sharp)
        limit_by_sharp_edges();
    find_growth();
    grade();
}

void Sizing::make_input_sizes(std::span<const double> wanted) {
    const std::size_t count = mesh_.points.size();
    std::vector<double> volume(count, 0.0);
    std::vector<double> tets(count, 0.0);
    volume_ = 0.0;
    for (const auto &[a, b, c, d] : mesh_.tets) {
        const auto &at = mesh_.points;
        const double v = std::fabs(six_volumes(at[a], at[b], at[c], at[d])) / 6.0;
        volume_ += v;
        for (const int at : {a, b, c, d}) {
            volume[at] += v;
            tets[at] += 1.0;
        }
    }
    // n BCC tets of cell a fill n a^3 / 12.
    const auto cell = [](double v, double n) { return std::cbrt(12.0 * v / n); };
    input_.assign(count, 0.0);
    if (!wanted.empty()) {
        input_.assign(wanted.begin(), wanted.end());
    } else {
        for (std::size_t v = 0; v < count; ++v)
            input_[v] = tets[v] > 0.0 ? cell(volume[v], tets[v]) / kCellPerEdge : kInfinity;
    }
    const auto around = neighbours(mesh_.tets, count);
    const int passes = wanted.empty() ? 4 : 0;
    for (int pass = 0; pass < passes; ++pass) { // a mesher's sizes scatter; the lattice wants them smooth
        auto smooth = input_;
        for (std::size_t v = 0; v < count; ++v) {
            if (around[v].empty())
                continue;
            double sum = std::log(input_[v]);
            for (const int w : around[v])
                sum += std::log(input_[w]);
            smooth[v] = std::exp(sum / static_cast<double>(around[v].size() + 1));
        }
        input_ = std::move(smooth);
    }
    smallest_ = kInfinity;
    largest_ = 0.0;
    for (std::size_t v = 0; v < count; ++v)
        if (tets[v] > 0.0) {
            smallest_ = std::min(smallest_, input_[v]);
            largest_ = std::max(largest_, input_[v]);
        }
    // What is uniform but for scatter is treated as uniform: then the lattice is one piece.
    uniform_ = largest_ < 1.5 * smallest_;
    if (uniform_) {
        const double one = wanted.empty() ? cell(volume_, static_cast<double>(mesh_.tets.size())) / kCellPerEdge
                                          : 0.5 * (smallest_ + largest_);
        input_.assign(count, one);
        smallest_ = largest_ = one;
    } else {
        limit_gradient(input_, mesh_.points, around, form_.inner_grade);
    }
}

void Sizing::limit_by_wires() {
    constexpr double much = 0.85; // of the size there: for less, a finer level of the lattice would be too much
    for (std::size_t c = 0; c < reference_.curves().size(); ++c) {
        const Curve &curve = reference_.curves()[c];
        if (!reference_.patches_at_curve(static_cast<int>(c)).empty())
            continue;
        for (std::size_t k = 0; k < curve.vertices.size(); ++k) {
            const int v = curve.vertices[k];
            const double sag = norm(curve.bend[k]) / 8.0;
            double size = form_.most.empty() ? kInfinity : form_.most[v];
            if (sag > 0.0)
                size = std::min(size, std::sqrt(form_.sag * form_.tolerance_at(v) / sag));
            if (size < much * limit_[v])
                form_.limits.push_back({reference_.data().points[v], size});
        }
    }
}

void Sizing::limit_by_places() {
    constexpr double reach = 2.0; // in sizes, as far as they do not grow
    if (form_.limits.empty())
        return;
    uniform_ = false;
    for (std::size_t v = 0; v < input_.size(); ++v)
        for (const SizeLimit &limit : form_.limits) {
            const double beyond = std::max(0.0, norm(mesh_.points[v] - limit.at) - reach * limit.size);
            input_[v] = std::min(input_[v], limit.size + form_.inner_grade * beyond);
        }
    for (const auto &tet : mesh_.tets)
        for (const int v : tet)
            smallest_ = std::min(smallest_, input_[v]);
}

double Sizing::sag() const {
    double area = 0.0;
    for (std::size_t t = 0; t < reference_.data().triangles.size(); ++t)
        if (!reference_.planar(reference_.data().patch[t]))
            area += reference_.area(static_cast<int>(t));
    const double lost = form_.lost_depth * form_.tolerance * area / volume_;
    const double free = lost > form_.lost_volume ? form_.lost_volume / lost : 1.0;
    return form_.keeping_sag + free * (form_.sag - form_.keeping_sag);
}

void Sizing::limit_by_curvature() {
    const double allowed = sag();
    curved_.assign(reference_.data().points.size(), kInfinity);
    const auto lower = [&](int vertex, double sag) {
        if (sag > 0.0)
            curved_[vertex] = std::min(curved_[vertex], std::sqrt(allowed * form_.tolerance_at(vertex) / sag));
    };
    for (int w = 0; w < reference_.wedges(); ++w)
        lower(reference_.wedge_vertex(w), unit_sag(reference_.curvature(w)[0], reference_.curvature(w)[1]));
    for (const Curve &curve : reference_.curves())
        for (std::size_t k = 0; k < curve.vertices.size(); ++k)
            lower(curve.vertices[k], norm(curve.bend[k]) / 8.0);
}

void Sizing::limit_by_bends() {
    constexpr double bent = 0.574;   // cosine of 55 degrees
    constexpr double shortest = 4.0; // in tolerances
    struct Side {
        std::array<int, 2> ends; // wedges: those on either side of a crease differ
        int triangle;
        bool forward; // runs from the first end to the second
    };
    const auto &data = reference_.data();
    std::vector<Side> sides;
    for (int t = 0; t < static_cast<int>(data.triangles.size()); ++t)
        for (int k = 0; k < 3 && !reference_.planar(data.patch[t]); ++k) {
            const int from = reference_.wedge(t, k), to = reference_.wedge(t, (k + 1) % 3);
            sides.push_back({sorted(from, to), t, from < to});
        }
    std::sort(sides.begin(), sides.end(),
              [](const Side &a, const Side &b) { return std::tie(a.ends, a.triangle) < std::tie(b.ends, b.triangle); });
    for (std::size_t s = 1; s < sides.size(); ++s) {
        const int t = sides[s - 1].triangle, u = sides[s].triangle;
        // Triangles of an interface or a sheet inside may run either way.
        const double turned = sides[s].forward == sides[s - 1].forward ? -1.0 : 1.0;
        const double cosine = std::clamp(turned * dot(reference_.normal(t), reference_.normal(u)), -1.0, 1.0);
        if (sides[s].ends != sides[s - 1].ends || cosine > bent)
            continue;
        const int v = reference_.wedge_vertex(sides[s].ends[0]), w = reference_.wedge_vertex(sides[s].ends[1]);
        const double tolerance = std::min(form_.tolerance_at(v), form_.tolerance_at(w));
        const double deep = form_.sag * tolerance;
        const double base = norm(data.points[w] - data.points[v]);
        const double height = 2.0 * std::min(reference_.area(t), reference_.area(u)) / base;
        const double half_sine = std::sqrt(0.5 * (1.0 - cosine)), half_cosine = std::sqrt(0.5 * (1.0 + cosine));
        if (!(height * half_sine > deep)) // noise: nothing there is too deep
            continue;
        // A facet's edge of length l is l / 2 tan(bend / 2) deep at most, and half of that where it crosses by chance.
        const double most = std::max(4.0 * deep * half_cosine / half_sine, shortest * tolerance);
        surface[v] = std::min(surface[v], most);
        surface[w] = std::min(surface[w], most);
    }
}

void Sizing::limit_by_creases() {
    for (int c = 0; c < static_cast<int>(reference_.curves().size()); ++c) {
        const Curve &curve = reference_.curves()[c];
        const double length = reference_.length(c);
        for (const int v : curve.vertices) {
            const bool across = !curve.closed && length < kAcross * layer_[v];
            const double most = across ? kHalf * length : length / curve.least_edges();
            surface[v] = std::min(surface[v], std::max(most, form_.narrowest * form_.tolerance_at(v)));
        }
    }
}

void Sizing::limit_by_passing_creases() {
    std::vector<double> reach(surface.size(), 0.0);
    for (std::size_t v = 0; v < reach.size(); ++v)
        if (layer_[v] == 0.0) // layers have sizes of their own
            reach[v] = surface[v] / kPassing;
    const std::vector<double> apart = passing_distances(reference_, reach);
    for (std::size_t v = 0; v < reach.size(); ++v)
        if (apart[v] < kInfinity)
            surface[v] = std::min(
                surface[v], std::max(kPassing * apart[v], form_.narrowest * form_.tolerance_at(static_cast<int>(v))));
}

void Sizing::limit_by_sharp_edges() {
    std::vector<double> narrow(surface.size(), 1.0);
    for (int edge = 0; edge < sharp_.count(); ++edge)
        for (const int v : sharp_.ends(edge))
            narrow[v] = std::min(narrow[v], sharp_.narrow(edge));
    for (std::size_t v = 0; v < surface.size(); ++v)
        surface[v] *= narrow[v];
}

double Sizing::clearance(const SharpFoot &foot) const {
    constexpr double thick = 0.8; // the region there, in edges along the crease
    const auto &[v, w] = sharp_.ends(foot.edge);
    return thick * ((1.0 - foot.along) * surface[v] + foot.along * surface[w]) / sharp_.narrow(foot.edge);
}

SharpFoot Sizing::cleared_by(const Vec3 &p) const {
    if (sharp_.empty())
        return {};
    const SharpFoot foot = sharp_.nearest(p, form_.coarsen * largest_);
    return foot.edge >= 0 && foot.distance < clearance(foot) && sharp_.takes_in(foot, p) ? foot : SharpFoot{};
}

void Sizing::find_growth() {
    const bool parted = reference_.has_inner();
    for (int t = 0; t < static_cast<int>(reference_.data().triangles.size()); ++t)
        growth_.push_back(parted && !at_layer(t) ? SizingForm::parted_grade : SizingForm::inner_grade);
    least_growth_ = reference_.tree().smallest(growth_);
}

bool Sizing::at_layer(int triangle) const {
    return std::ranges::any_of(reference_.data().triangles[triangle], [&](int v) { return layer_[v] > 0.0; });
}

bool Sizing::bent_inside(int triangle) const {
    const int patch = reference_.data().patch[triangle];
    return reference_.inner(patch) && !reference_.planar(patch);
}

std::array<double, 2> Sizing::flat_depths(int triangle, double size) const {
    const int patch = reference_.data().patch[triangle];
    const std::array<double, 2> &wall = wall_[triangle];
    const bool row = at_layer(triangle) && reference_.has_inner();
    // The few layers of a thin wall are made at one size: where its middle has longer edges than its sides, tets there
    // are mostly bad. Round a concave bend the region goes on on the other side of an outer triangle's plane.
    const auto waits = [&](double thickness) { return thickness < kThick * size ? 0.5 * thickness : 0.0; };
    if (!reference_.inner(patch)) {
        const double depth = row ? 0.0 : waits(std::min(wall[0], wall[1]));
        return {depth, depth};
    }
    // Nothing is between the sides of a layer of one row; beyond it tets are too tall where sizes grow at once. So the
    // layer on one side of its interface lets sizes wait on the other.
    if (row)
        return {waits(wall[1]), waits(wall[0])};
    if (!bent_inside(triangle)) // curved interfaces have no wall, see Thickness
        return {waits(wall[0]), waits(wall[1])};
    double bend = 0.0; // away from the normal
    for (int k = 0; k < 3; ++k)
        for (const double curvature : reference_.curvature(reference_.wedge(triangle, k)))
            bend += curvature;
    const auto &[behind, before] = apart_[triangle];
    return {bend > 0.0 || behind < kThickBent * size ? kHollow * size : 0.0,
            bend <= 0.0 || before < kThickBent * size ? kHollow * size : 0.0};
}

void Sizing::grade() {
    const auto &data = reference_.data();
    limit_gradient(surface, data.points, neighbours(data.triangles, data.points.size()), form_.surface_grade);
    flat_.clear();
    std::vector<double> sizes, from;
    for (std::size_t t = 0; t < data.triangles.size(); ++t) {
        const auto &[a, b, c] = data.triangles[t];
        const double size = std::min({surface[a], surface[b], surface[c]});
        flat_.push_back(flat_depths(static_cast<int>(t), size));
        sizes.push_back(size);
        from.push_back(size - growth_[t] * std::max(flat_[t][0], flat_[t][1]));
        smallest_ = std::min(smallest_, size);
    }
    least_ = reference_.tree().smallest(sizes);
    least_from_ = reference_.tree().smallest(from);
}

double SizingForm::least_at(int patch, const Reference &reference) const {
    double least = tolerance;
    const SurfaceData &data = reference.data();
    for (std::size_t t = 0; t < data.triangles.size() && !local.empty(); ++t)
        if (data.patch[t] == patch)
            for (const int v : data.triangles[t])
                least = std::min(least, local[v]);
    return least;
}

double Sizing::input_size(const Vec3 &p) const {
    if (uniform_)
        return input_.front();
    const Place place = map_.find_or_nearest(p);
    double size = 0.0;
    for (int k = 0; k < 4; ++k)
        size += place.weight[k] * input_[mesh_.tets[place.tet][k]];
    return size;
}

double Sizing::at(const Vec3 &p) const {
    int triangle = -1;
    return at(p, triangle);
}

double Sizing::at(const Vec3 &p, int &triangle) const {
    const auto &data = reference_.data();
    const geometry::BoxTree &tree = reference_.tree();
    const auto from = [&](std::size_t item) {
        const auto &[a, b, c] = data.triangles[item];
        const geometry::TrianglePoint q =
            geometry::nearest_on_triangle(p, data.points[a], data.points[b], data.points[c]);
        const auto &[behind, before] = flat_[item];
        double flat = behind;
        if (behind != before) { // any point of the triangle tells the side
            const bool is_before = dot(p - data.points[a], reference_.normal(static_cast<int>(item))) > 0.0;
            flat = is_before ? before : behind;
        }
        return q.weight[0] * surface[a] + q.weight[1] * surface[b] + q.weight[2] * surface[c] +
               growth_[item] * std::max(0.0, std::sqrt(q.square) - flat);
    };
    double most = form_.coarsen * input_size(p);
    if (triangle >= 0)
        most = std::min(most, from(static_cast<std::size_t>(triangle)));
    return tree.minimise(
        most,
        [&](std::size_t node) {
            return std::max(least_[node],
                            least_from_[node] + least_growth_[node] * std::sqrt(tree.box(node).square(p)));
        },
        [&](std::size_t item, double best) {
            const double size = from(item);
            if (size < best)
                triangle = static_cast<int>(item);
            return size;
        });
}

} // namespace wct::domain
