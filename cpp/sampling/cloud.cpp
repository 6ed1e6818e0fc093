#include "sampling/cloud.h"

#include "base/random.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>
#include <utility>

namespace wct::sampling {

namespace {

/// The cell's number along an axis. What is too far off for a number is all in the last cell there: circles through
/// points that are almost on a line have their centers anywhere, and a conversion out of range could be any number.
std::int64_t cell_of(double x, double cell) {
    constexpr double kFar = 0x1p62;
    const double number = std::floor(x / cell);
    return static_cast<std::int64_t>(number < -kFar ? -kFar : number < kFar ? number : kFar);
}

} // namespace

void Cloud::keep(const std::vector<char> &which) {
    std::size_t to = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (which[i]) {
            points[to] = points[i];
            role[to] = role[i];
            label[to] = label[i];
            size[to] = size[i];
            near[to] = near[i];
            held[to] = held[i];
            drift[to] = drift[i];
            ++to;
        }
    points.resize(to);
    role.resize(to);
    label.resize(to);
    size.resize(to);
    near.resize(to);
    held.resize(to);
    drift.resize(to);
}

void Cloud::append(const Cloud &other) {
    points.insert(points.end(), other.points.begin(), other.points.end());
    role.insert(role.end(), other.role.begin(), other.role.end());
    label.insert(label.end(), other.label.begin(), other.label.end());
    size.insert(size.end(), other.size.begin(), other.size.end());
    near.insert(near.end(), other.near.begin(), other.near.end());
    held.insert(held.end(), other.held.begin(), other.held.end());
    drift.insert(drift.end(), other.drift.begin(), other.drift.end());
}

std::vector<int> patches_of(const Cloud &cloud, const domain::Reference &reference, int point) {
    switch (cloud.role[point]) {
    case Stratum::patch:
        return {cloud.label[point]};
    case Stratum::crease:
        return reference.patches_at_curve(cloud.label[point]);
    case Stratum::corner:
        return reference.patches_at_vertex(cloud.label[point]);
    case Stratum::interior:
        break;
    }
    return {};
}

bool on_curved(const Cloud &cloud, const domain::Reference &reference, int point) {
    const std::vector<int> own = patches_of(cloud, reference, point);
    return std::any_of(own.begin(), own.end(), [&](int patch) { return !reference.planar(patch); });
}

std::vector<int> shared_patches(const Cloud &cloud, const domain::Reference &reference, std::span<const int> points) {
    std::vector<int> shared = patches_of(cloud, reference, points.front());
    for (const int point : points.subspan(1)) {
        const std::vector<int> own = patches_of(cloud, reference, point);
        std::vector<int> both;
        std::set_intersection(shared.begin(), shared.end(), own.begin(), own.end(), std::back_inserter(both));
        shared = std::move(both);
    }
    return shared;
}

bool cuts_across(const Cloud &cloud, const domain::Reference &reference, const Facet &facet) {
    return shared_patches(cloud, reference, facet).empty() &&
           std::none_of(facet.begin(), facet.end(), [&](int v) { return on_curved(cloud, reference, v); });
}

bool is_astray(const Cloud &cloud, const domain::Reference &reference, const Tet &tet, int region) {
    return std::any_of(tet.begin(), tet.end(), [&](int v) {
        if (cloud.role[v] != Stratum::patch)
            return false;
        const auto &[behind, before] = reference.sides(cloud.label[v]);
        return region != behind && region != before;
    });
}

std::vector<char> on_wires(const Cloud &cloud, const domain::Reference &reference) {
    std::vector<char> ends(reference.data().points.size(), 0);
    for (std::size_t c = 0; c < reference.curves().size(); ++c) {
        const domain::Curve &curve = reference.curves()[c];
        if (!curve.vertices.empty() && reference.patches_at_curve(static_cast<int>(c)).empty())
            ends[curve.vertices.front()] = ends[curve.vertices.back()] = 1;
    }
    std::vector<char> out(cloud.count(), 0);
    for (std::size_t i = 0; i < cloud.count(); ++i)
        out[i] = cloud.role[i] == Stratum::crease   ? reference.patches_at_curve(cloud.label[i]).empty()
                 : cloud.role[i] == Stratum::corner ? ends[cloud.label[i]]
                                                    : 0;
    return out;
}

bool drop_twins(Cloud &cloud) {
    std::vector<std::size_t> order(cloud.count());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key_of = [&](std::size_t i) {
        const Vec3 &p = cloud.points[i];
        return std::tuple(p.x, p.y, p.z);
    };
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
        if (key_of(i) != key_of(j))
            return key_of(i) < key_of(j);
        const bool given = cloud.held[i] == Hold::given, other = cloud.held[j] == Hold::given;
        if (given != other)
            return given;
        return cloud.role[i] != cloud.role[j] ? cloud.role[i] > cloud.role[j] : i < j;
    });
    std::vector<char> keep(cloud.count(), 1);
    bool any = false;
    for (std::size_t k = 1; k < order.size(); ++k)
        if (key_of(order[k]) == key_of(order[k - 1])) {
            keep[order[k]] = 0;
            any = true;
        }
    if (any)
        cloud.keep(keep);
    return any;
}

namespace {

constexpr std::size_t kChunk = 512; // points

/// The point of its patch nearest to a patch point, whose triangle it remembers.
domain::Foot foot_on_patch(Cloud &cloud, const domain::Reference &reference, std::size_t i) {
    const domain::Foot foot = reference.nearest(cloud.points[i], cloud.label[i], cloud.near[i]);
    cloud.near[i] = foot.triangle;
    return foot;
}

/// Put a point on its crease or corner; returns the tangent there. Others stay.
Vec3 retract_to_crease(Cloud &cloud, const domain::Reference &reference, std::size_t i) {
    if (cloud.role[i] == Stratum::crease)
        return reference.to_curve(cloud.points[i], cloud.label[i]);
    if (cloud.role[i] == Stratum::corner)
        cloud.points[i] = reference.data().points[cloud.label[i]];
    return {};
}

} // namespace

void retract(Cloud &cloud, const domain::Reference &reference, const Workers &workers) {
    workers.for_each(cloud.count(), kChunk, [&](std::size_t i) {
        if (cloud.held[i] >= Hold::all)
            return;
        if (cloud.role[i] == Stratum::patch)
            reference.to_patch(cloud.points[i], foot_on_patch(cloud, reference, i));
        else
            retract_to_crease(cloud, reference, i);
    });
}

void retract_to_shell(Cloud &cloud, const domain::Reference &reference, double shell, std::vector<Vec3> &direction,
                      const Workers &workers) {
    direction.assign(cloud.count(), {});
    workers.for_each(cloud.count(), kChunk, [&](std::size_t i) {
        Vec3 &p = cloud.points[i];
        const Vec3 before = p;
        if (cloud.role[i] != Stratum::patch) {
            direction[i] = retract_to_crease(cloud, reference, i);
        } else {
            const domain::Foot foot = foot_on_patch(cloud, reference, i);
            if (reference.planar(cloud.label[i])) {
                direction[i] = reference.to_patch(p, foot);
            } else {
                if (foot.distance > shell)
                    p = foot.point + (shell / foot.distance) * (p - foot.point);
                direction[i] = reference.smooth_normal(foot);
            }
        }
        if (cloud.held[i] >= Hold::all)
            p = before;
    });
}

std::size_t PointGrid::IndexHash::operator()(const Index &index) const {
    std::uint64_t hash = 0;
    for (const std::int64_t along : index)
        hash = mix(hash ^ static_cast<std::uint64_t>(along));
    return hash;
}

void PointGrid::add(const Vec3 &p, double radius) {
    const double cell = std::exp2(std::ceil(std::log2(radius)));
    auto at = levels_.begin();
    while (at != levels_.end() && at->cell < cell)
        ++at;
    if (at == levels_.end() || at->cell != cell)
        at = levels_.insert(at, Level{cell, {}, {}});
    Index index{cell_of(p.x, cell), cell_of(p.y, cell), cell_of(p.z, cell)};
    const auto [found, fresh] = at->cells.try_emplace(index);
    found->second.push_back({p, radius});
    bool unknown = fresh;
    for (auto &blocks : at->blocks) {
        if (!unknown)
            break;
        const Index above{index[0] >> kShift, index[1] >> kShift, index[2] >> kShift};
        const auto [block, made] = blocks.try_emplace(above);
        block->second.push_back(index);
        unknown = made;
        index = above;
    }
}

bool PointGrid::Level::cell_hit(const Index &index, const Query &query) const {
    const auto found = cells.find(index);
    return found != cells.end() && std::any_of(found->second.begin(), found->second.end(), [&](const Item &item) {
               const Vec3 d = item.point - query.point;
               const double limit = 0.5 * (query.radius + item.radius);
               return dot(d, d) < limit * limit && !(query.but && item.point == *query.but);
           });
}

bool PointGrid::Level::reaches(int level, const Index &index, const Query &query) const {
    const double side = std::ldexp(cell, kShift * (level + 1)), limit = 0.5 * (query.radius + cell);
    const auto off = [&](double x, std::int64_t along) {
        const double low = static_cast<double>(along) * side;
        return std::max({0.0, low - x, x - (low + side)});
    };
    const double x = off(query.point.x, index[0]), y = off(query.point.y, index[1]), z = off(query.point.z, index[2]);
    return x * x + y * y + z * z <= limit * limit;
}

bool PointGrid::Level::block_hit(int level, const Index &index, const Query &query) const {
    if (!reaches(level, index, query))
        return false;
    if (level < 0)
        return cell_hit(index, query);
    const auto &below = blocks[static_cast<std::size_t>(level)].at(index);
    return std::any_of(below.begin(), below.end(), [&](const Index &one) { return block_hit(level - 1, one, query); });
}

bool PointGrid::crowded(const Query &query) const {
    constexpr double few = 64.0; // cells
    for (const Level &level : levels_) {
        const double reach = 0.5 * (query.radius + level.cell); // no radius on this level exceeds its cell
        const double across = 2.0 * reach / level.cell + 1.0;
        if (across * across * across > few) {
            for (const auto &[index, below] : level.blocks.back())
                if (level.block_hit(kBlocks - 1, index, query))
                    return true;
            continue;
        }
        const Vec3 &p = query.point;
        const auto lo = [&](double x) { return cell_of(x - reach, level.cell); };
        const auto hi = [&](double x) { return cell_of(x + reach, level.cell); };
        for (auto i = lo(p.x); i <= hi(p.x); ++i)
            for (auto j = lo(p.y); j <= hi(p.y); ++j)
                for (auto k = lo(p.z); k <= hi(p.z); ++k)
                    if (level.cell_hit({i, j, k}, query))
                        return true;
    }
    return false;
}

PointGrid surface_grid(const Cloud &cloud, double share) {
    PointGrid grid;
    for (std::size_t i = 0; i < cloud.count(); ++i)
        if (cloud.role[i] != Stratum::interior)
            grid.add(cloud.points[i], share * cloud.size[i]);
    return grid;
}

} // namespace wct::sampling
