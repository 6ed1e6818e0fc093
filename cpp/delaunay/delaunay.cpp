// Incremental insertion after Bowyer (1981) and Watson (1981): the tets whose sphere holds the new point make a cavity
// that is star-shaped from it, and are replaced by the tets that join it to the cavity's facets. The outside of the
// hull is covered by ghosts, tets of a hull facet and a vertex at infinity, so that a point outside is no special case.

#include "delaunay/builder.h"

#include "base/random.h"
#include "geometry/box_tree.h"
#include "geometry/predicates.h"

#include <algorithm>
#include <array>
#include <bit>
#include <climits>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace wct::delaunay {

namespace {

// --- Insertion order -------------------------------------------------------------------------------------------------

constexpr int kBits = 20; // per axis

/// Position along a Hilbert curve of a cell of the 2^kBits grid (Skilling, "Programming the Hilbert curve", 2004).
std::uint64_t hilbert_key(std::array<std::uint32_t, 3> cell) {
    for (std::uint32_t bit = 1u << (kBits - 1); bit > 1; bit >>= 1) {
        const std::uint32_t below = bit - 1;
        for (std::uint32_t &axis : cell) {
            if (axis & bit) {
                cell[0] ^= below;
            } else {
                const std::uint32_t differ = (cell[0] ^ axis) & below;
                cell[0] ^= differ;
                axis ^= differ;
            }
        }
    }
    cell[1] ^= cell[0];
    cell[2] ^= cell[1];
    std::uint32_t flip = 0;
    for (std::uint32_t bit = 1u << (kBits - 1); bit > 1; bit >>= 1)
        if (cell[2] & bit)
            flip ^= bit - 1;
    std::uint64_t key = 0;
    for (int bit = kBits - 1; bit >= 0; --bit)
        for (const std::uint32_t axis : cell)
            key = key << 1 | ((axis ^ flip) >> bit & 1);
    return key;
}

/// Sorts the points named along a Hilbert curve through their bounding box. A cell that still holds many of them gets a
/// curve of its own, so clusters of any scale are in order too.
void sort_along_curve(std::span<const Vec3> points, std::span<int> ids) {
    constexpr std::size_t few = 16;
    geometry::Box box;
    for (const int id : ids)
        box.add(points[id]);
    const Vec3 low = box.lo, high = box.hi; // no structured binding: a lambda takes them
    // Halved first: the extent of finite points may overflow. The cells are cubes, as the tets will be.
    const double extent =
        std::max({high.x / 2 - low.x / 2, high.y / 2 - low.y / 2, high.z / 2 - low.z / 2}) * (1.0 + 0x1p-40);
    if (!(extent > 0.0))
        return;
    constexpr double cells = 1 << kBits;
    const auto cell = [&](double value, double least) {
        return static_cast<std::uint32_t>((value / 2 - least / 2) / extent * cells);
    };
    std::vector<std::pair<std::uint64_t, int>> keyed(ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const Vec3 &p = points[ids[i]];
        keyed[i] = {hilbert_key({cell(p.x, low.x), cell(p.y, low.y), cell(p.z, low.z)}), ids[i]};
    }
    std::sort(keyed.begin(), keyed.end());
    for (std::size_t i = 0; i < ids.size(); ++i)
        ids[i] = keyed[i].second;
    for (std::size_t first = 0; first < ids.size();) {
        std::size_t last = first + 1;
        while (last < ids.size() && keyed[last].first == keyed[first].first)
            ++last;
        if (last - first > few && last - first < ids.size())
            sort_along_curve(points, ids.subspan(first, last - first));
        first = last;
    }
}

/// A biased randomized insertion order (Amenta, Choi, Rote 2003): rounds of points chosen at random, each some seven
/// times as many as all before it, so that the expected work is that of a random order; within a round the points
/// follow a curve, so that each is near the one before.
std::vector<int> insertion_order(std::span<const Vec3> points) {
    constexpr int rounds = 8;
    constexpr int log_ratio = 3;
    std::array<int, rounds + 1> start{};
    std::vector<std::uint8_t> round(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const int level = std::countr_zero(mix(i + Random::kStep)) / log_ratio;
        round[i] = static_cast<std::uint8_t>(std::max(rounds - 1 - level, 0));
        ++start[round[i] + 1];
    }
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<int> order(points.size());
    std::array<int, rounds + 1> next = start;
    for (std::size_t i = 0; i < points.size(); ++i)
        order[next[round[i]]++] = static_cast<int>(i);
    for (int r = 0; r < rounds; ++r)
        if (start[r] < start[r + 1])
            sort_along_curve(points, std::span(order).subspan(start[r], start[r + 1] - start[r]));
    return order;
}

} // namespace

// --- Construction ----------------------------------------------------------------------------------------------------

namespace {

[[noreturn]] void refuse(const std::string &what) {
    throw std::invalid_argument("delaunay: " + what);
}

} // namespace

Builder::Builder(std::span<const Vec3> points) {
    if (points.size() < 4)
        refuse("needs at least 4 points, got " + std::to_string(points.size()));
    if (points.size() > static_cast<std::size_t>(INT_MAX / 2))
        throw std::length_error("delaunay: too many points: " + std::to_string(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!std::isfinite(points[i].x) || !std::isfinite(points[i].y) || !std::isfinite(points[i].z))
            refuse("point " + std::to_string(i) + " is not finite");
    order_ = insertion_order(points);
    points_.reserve(points.size());
    for (const int id : order_)
        points_.push_back(points[id]);
    // Random points make 6.8 tets each, and the hull its ghosts.
    const std::size_t expected = 7 * points.size() + points.size() / 2 + 64;
    tets_.reserve(expected);
    start();
    for (int vertex = 4; vertex < static_cast<int>(points_.size()); ++vertex)
        insert(vertex);
}

void Builder::refuse_pair(int i, int j) const {
    const auto [first, second] = std::minmax(order_[i], order_[j]);
    refuse("points " + std::to_string(first) + " and " + std::to_string(second) + " coincide");
}

/// Moves the first points that span space to the front of the order, and makes their tet and its four ghosts.
void Builder::start() {
    const auto bring = [this](int to, auto fits) {
        const auto found = std::find_if(points_.begin() + to, points_.end(), fits);
        if (found == points_.end())
            refuse("all " + std::to_string(points_.size()) + " points lie in one plane");
        const auto from = found - points_.begin();
        std::rotate(points_.begin() + to, found, found + 1);
        std::rotate(order_.begin() + to, order_.begin() + from, order_.begin() + from + 1);
    };
    if (points_[0] == points_[1])
        refuse_pair(0, 1);
    bring(2, [this](const Vec3 &p) {
        // No plane holds all four of these, so three points on a line are the only ones coplanar with each.
        constexpr std::array<Vec3, 4> frame{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
        return std::any_of(frame.begin(), frame.end(),
                           [&](const Vec3 &q) { return geometry::orient3d(points_[0], points_[1], p, q) != 0; });
    });
    bring(3, [this](const Vec3 &p) { return geometry::orient3d(points_[0], points_[1], points_[2], p) != 0; });
    std::array<int, 4> first{0, 1, 2, 3};
    if (geometry::orient3d(points_[0], points_[1], points_[2], points_[3]) < 0)
        std::swap(first[0], first[1]);
    constexpr std::array<int, 4> open{kOpen, kOpen, kOpen, kOpen};
    tets_.push_back({first, open, 0});
    // The other three corners, in order, turn outward for an even corner left out and inward for an odd one.
    for (int i = 0; i < 4; ++i) {
        std::array<int, 4> ghost{};
        for (int j = 0, k = 0; j < 4; ++j)
            if (j != i)
                ghost[k++] = first[j];
        if (i % 2)
            std::swap(ghost[0], ghost[1]);
        ghost[3] = kInfinite;
        tets_.push_back({ghost, open, 0});
    }
    // Facets match where their corners do.
    const auto facet_of = [this](int facet) {
        std::array<int, 3> out{};
        for (int j = 0, k = 0; j < 4; ++j)
            if (j != facet % 4)
                out[k++] = tets_[facet / 4].corners[j];
        std::sort(out.begin(), out.end());
        return out;
    };
    for (int f = 0; f < 20; ++f)
        for (int g = 0; g < 20; ++g)
            if (f != g && facet_of(f) == facet_of(g))
                across(f) = g;
}

/// The side of the facet, of a tet that is no ghost, that p is on: 1 the tet's own.
int Builder::side(int facet, const Vec3 &p) const {
    const int tet = facet >> 2;
    std::array<const Vec3 *, 4> q{&corner(tet, 0), &corner(tet, 1), &corner(tet, 2), &corner(tet, 3)};
    q[facet & 3] = &p;
    return geometry::orient3d(*q[0], *q[1], *q[2], *q[3]);
}

/// A tet that holds p, or a ghost whose facet p sees from outside. Crossing any facet that p lies beyond leads there:
/// the power distance to the (perturbed) spheres decreases on the way, so no tet is seen twice.
int Builder::locate(const Vec3 &p) const {
    int tet = is_ghost(last_) ? tets_[last_].across[3] >> 2 : last_;
    for (int entry = -1;;) {
        int exit = -1;
        for (int i = 0; i < 4 && exit < 0; ++i)
            if (i != entry && side(4 * tet + i, p) < 0)
                exit = i;
        if (exit < 0)
            return tet;
        const int facet = tets_[tet].across[exit];
        tet = facet >> 2;
        entry = facet & 3;
        if (is_ghost(tet))
            return tet;
    }
}

bool Builder::in_conflict(int tet, const Vec3 &p) const {
    if (!is_ghost(tet))
        return in_perturbed_sphere(tet, p);
    const int sign = geometry::orient3d(corner(tet, 0), corner(tet, 1), corner(tet, 2), p);
    if (sign != 0)
        return sign > 0;
    // In the plane of the hull facet, where the sphere of the tet behind it cuts the facet's circle.
    return in_perturbed_sphere(tets_[tet].across[3] >> 2, p);
}

/// Whether p lies inside the sphere of a tet. On it, as if each point were raised above the paraboloid by an amount
/// that is infinitely greater than that of the points lexicographically before it (Devillers, Teillaud, "Perturbations
/// and vertex removal in a 3D Delaunay triangulation", 2003). The result is a regular triangulation for some weights
/// near zero, so it exists, is unique, and holds no flat tet.
bool Builder::in_perturbed_sphere(int tet, const Vec3 &p) const {
    std::array<const Vec3 *, 5> q{&corner(tet, 0), &corner(tet, 1), &corner(tet, 2), &corner(tet, 3), &p};
    const int sign = geometry::insphere(*q[0], *q[1], *q[2], *q[3], p);
    if (sign != 0)
        return sign > 0;
    std::array<int, 5> rank{0, 1, 2, 3, 4};
    std::sort(rank.begin(), rank.end(), [&](int i, int j) { return lies_before(*q[j], *q[i]); });
    for (const int i : rank) {
        if (i == 4)
            return false; // p itself is raised most among those that count, thus above the plane of the others
        // The coefficient of corner i's raise: raised, it lifts the plane over p if they are on the same side.
        std::array<const Vec3 *, 4> r{q[0], q[1], q[2], q[3]};
        r[i] = &p;
        if (const int turn = geometry::orient3d(*r[0], *r[1], *r[2], *r[3]); turn != 0)
            return turn > 0;
    }
    return false;
}

int Builder::take_tet() {
    if (!unused_.empty()) {
        const int tet = unused_.back();
        unused_.pop_back();
        return tet;
    }
    const auto tet = tets_.size();
    if (tet >= std::size_t{1} << 29)
        throw std::length_error("delaunay: more than 2^29 tets");
    tets_.push_back({});
    return static_cast<int>(tet);
}

void Builder::insert(int vertex) {
    const Vec3 &p = points_[vertex];
    const int tet = locate(p);
    // The closed tet that holds p lies inside its sphere but for its corners, the facet seen is in conflict anyway.
    for (int i = 0; i < (is_ghost(tet) ? 3 : 4); ++i)
        if (corner(tet, i) == p)
            refuse_pair(tets_[tet].corners[i], vertex);
    dig(vertex, tet);
    fill(vertex);
}

/// Finds the tets in conflict with the vertex, which are connected, from one of them. Afterwards cavity_ holds them and
/// rim_ their facets towards the others.
void Builder::dig(int vertex, int tet) {
    const Vec3 &p = points_[vertex];
    const int in = 2 * vertex;
    const int out = in + 1;
    cavity_.assign(1, tet);
    rim_.clear();
    tets_[tet].mark = in;
    for (std::size_t k = 0; k < cavity_.size(); ++k) {
        const int inside = cavity_[k];
        for (int i = 0; i < 4; ++i) {
            const int other = tets_[inside].across[i] >> 2;
            int &mark = tets_[other].mark;
            if (mark == in)
                continue;
            if (mark != out && in_conflict(other, p)) {
                mark = in;
                cavity_.push_back(other);
            } else {
                mark = out;
                rim_.push_back(4 * inside + i);
            }
        }
    }
}

/// Replaces the cavity by tets from the vertex to its rim.
void Builder::fill(int vertex) {
    for (const int facet : rim_) {
        const int created = take_tet();
        const Tet &old = tets_[facet >> 2];
        const int i = facet & 3;
        const int outside = old.across[i];
        Tet &tet = tets_[created];
        tet = {old.corners, {kOpen, kOpen, kOpen, kOpen}, 0};
        tet.corners[i] = vertex;
        tet.across[i] = outside;
        across(outside) = 4 * created + i;
        across(facet) = ~created; // negative: the rim, as join() meets it
    }
    for (const int facet : rim_)
        join(facet, ~across(facet));
    last_ = ~across(rim_.back());
    for (const int tet : cavity_)
        tets_[tet].corners[0] = kDead;
    unused_.insert(unused_.end(), cavity_.begin(), cavity_.end());
}

/// Joins the tet created on a facet of the rim to those created on the three facets next to it, each of which is found
/// by turning around their common edge through the cavity.
void Builder::join(int facet, int created) {
    for (int i = 0; i < 4; ++i) {
        if (tets_[created].across[i] != kOpen)
            continue;
        // The edge is what the facets opposite corner `exit` and opposite corner `back` of the tet share.
        int back = facet & 3;
        int exit = i;
        const Tet *tet = &tets_[facet >> 2];
        while (tet->across[exit] >= 0) {
            const int pivot = tet->corners[back]; // with the edge, the facet to be crossed
            const int entry = tet->across[exit];
            tet = &tets_[entry >> 2];
            back = entry & 3;
            // Without a branch: which corner it is cannot be predicted.
            exit = (tet->corners[1] == pivot) + 2 * (tet->corners[2] == pivot) + 3 * (tet->corners[3] == pivot);
        }
        const int mate = ~tet->across[exit];
        tets_[created].across[i] = 4 * mate + back;
        tets_[mate].across[back] = 4 * created + i;
    }
}

Triangulation Builder::result() const {
    Triangulation out;
    std::vector<int> number(tets_.size(), -1);
    int count = 0;
    for (std::size_t tet = 0; tet < tets_.size(); ++tet)
        if (tets_[tet].corners[0] != kDead && tets_[tet].corners[3] != kInfinite)
            number[tet] = count++;
    out.tets.reserve(count);
    out.neighbours.reserve(count);
    for (std::size_t tet = 0; tet < tets_.size(); ++tet) {
        if (number[tet] < 0)
            continue;
        const auto &c = tets_[tet].corners;
        const auto &a = tets_[tet].across;
        out.tets.push_back({order_[c[0]], order_[c[1]], order_[c[2]], order_[c[3]]});
        out.neighbours.push_back({number[a[0] >> 2], number[a[1] >> 2], number[a[2] >> 2], number[a[3] >> 2]});
    }
    return out;
}

Triangulation delaunay(std::span<const Vec3> points) {
    return Builder(points).result();
}

} // namespace wct::delaunay
