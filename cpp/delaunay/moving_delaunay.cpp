#include "delaunay/moving_delaunay.h"

#include "base/cells.h"
#include "base/sort_unique.h"
#include "delaunay/builder.h"
#include "geometry/predicates.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wct::delaunay {

namespace {

constexpr double kMostWrong = 0.04;     // share of tets at facets that are not Delaunay beyond which all is made anew
constexpr std::size_t kLargest = 1'500; // tets of a cavity
constexpr int kTries = 24;

/// A facet's vertices, ascending, and whether it takes an even number of swaps to sort them as its tet has them.
struct Key {
    Facet vertices;
    bool even;
};

/// Of the facet opposite corner i: outward, or inward, for all tets alike.
Key key_of(const std::array<int, 4> &corners, int i) {
    Key key{};
    for (int j = 0, k = 0; j < 4; ++j)
        if (j != i)
            key.vertices[k++] = corners[j];
    key.even = ascend(key.vertices) == (i % 2 == 0);
    return key;
}

bool have_twins(std::vector<Vec3> points) {
    std::sort(points.begin(), points.end(), lies_before);
    return std::adjacent_find(points.begin(), points.end()) != points.end();
}

} // namespace

/// A triangulation whose points may be put elsewhere.
class Mending : public Builder {
  public:
    using Builder::Builder;

    std::size_t count() const { return points_.size(); }
    /// Put the points elsewhere; afterwards it is Delaunay, or false: it is of no more use.
    bool move(std::span<const Vec3> points, const Workers &workers);

  private:
    /// A facet between the cavity and the tets round it.
    struct Rim {
        Key key;
        int outside;    // the facet, named from the tet outside
        int found = -1; // the same in the tets that are to fill the cavity, named from inside
    };

    const Vec3 &apex(int facet) const { return corner(facet >> 2, facet & 3); }
    /// Whether a facet is not locally Delaunay, or one of its tets not positive.
    bool is_broken(int facet) const;
    bool is_wrong(int tet) const;
    /// Whether it is not positive, or not Delaunay at a facet that it has in common with a tet of a greater number.
    bool is_first_wrong(int tet) const;
    /// Whether the tet, which is positive, and one beyond its facet, `outside` as named there, are at odds.
    bool at_odds(int tet, const Mending &there, int outside) const;
    bool mend(int tet);
    void take_in(int tet);
    void take_in_neighbours();
    /// Fill the cavity anew, or note in more_ which tets it needs too.
    bool refill();
    bool collect_vertices();
    void collect_rim();
    /// Find the rim among the facets of what is to fill the cavity.
    bool match(const Mending &made);
    /// Which of its tets lie within the rim; false: not all of the rim and the vertices do.
    bool flood(const Mending &made);
    void replace(const Mending &made);
    int number_of(const Mending &made, int vertex) const {
        return vertex < 0 ? vertex : vertices_[made.order_[vertex]];
    }

    std::vector<char> turned_; // by tet: whether it is not positive
    std::vector<int> stamp_;   // by tet: the last cavity it was in
    int now_ = 0;
    std::vector<int> cavity_tets_, more_;
    std::vector<int> vertices_; // of the cavity
    std::vector<Rim> rim_facets_;
    std::vector<char> stop_;   // by facet of what fills it: 1 on the rim, seen from inside, 2 from outside
    std::vector<char> inside_; // by tet of it
    std::vector<int> reached_; // those inside, in the order they are reached
};

bool Mending::is_broken(int facet) const {
    const int tet = facet >> 2, beyond = tets_[tet].across[facet & 3];
    return turned_[tet] || turned_[beyond >> 2] || at_odds(tet, *this, beyond);
}

bool Mending::at_odds(int tet, const Mending &there, int outside) const {
    const bool ghost = is_ghost(tet);
    if (ghost != there.is_ghost(outside >> 2))
        return false; // a hull facet: the tet behind is positive
    return ghost ? in_conflict(tet, there.apex(outside)) : in_perturbed_sphere(tet, there.apex(outside));
}

bool Mending::is_wrong(int tet) const {
    return turned_[tet] || is_broken(4 * tet) || is_broken(4 * tet + 1) || is_broken(4 * tet + 2) ||
           is_broken(4 * tet + 3);
}

bool Mending::is_first_wrong(int tet) const {
    bool any = turned_[tet];
    for (int i = 0; i < 4 && !any; ++i)
        any = tets_[tet].across[i] >> 2 > tet && is_broken(4 * tet + i);
    return any;
}

bool Mending::move(std::span<const Vec3> points, const Workers &workers) {
    for (std::size_t v = 0; v < points_.size(); ++v) {
        const Vec3 &p = points[order_[v]];
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
            return false;
        points_[v] = p;
    }
    constexpr std::size_t chunk = 1024;
    turned_.assign(tets_.size(), 0);
    stamp_.assign(tets_.size(), 0);
    now_ = 0;
    workers.for_each(tets_.size(), chunk, [this](std::size_t k) {
        const int t = static_cast<int>(k);
        turned_[t] =
            alive(t) && !is_ghost(t) && geometry::orient3d(corner(t, 0), corner(t, 1), corner(t, 2), corner(t, 3)) <= 0;
    });
    std::vector<int> wrong;
    workers.in_order<std::vector<int>>(
        tets_.size(), chunk,
        [this](std::size_t begin, std::size_t end, std::vector<int> &found) {
            found.clear();
            for (int t = static_cast<int>(begin); t < static_cast<int>(end); ++t)
                if (alive(t) && is_first_wrong(t))
                    found.push_back(t);
        },
        [&wrong](std::size_t, std::size_t, const std::vector<int> &found) {
            wrong.insert(wrong.end(), found.begin(), found.end());
        });
    if (static_cast<double>(wrong.size()) > kMostWrong * static_cast<double>(tets_.size()))
        return false;
    return std::all_of(wrong.begin(), wrong.end(), [this](int t) { return !alive(t) || !is_wrong(t) || mend(t); });
}

void Mending::take_in(int tet) {
    if (stamp_[tet] == now_)
        return;
    stamp_[tet] = now_;
    cavity_tets_.push_back(tet);
}

void Mending::take_in_neighbours() {
    for (std::size_t k = 0, size = cavity_tets_.size(); k < size; ++k)
        for (int i = 0; i < 4; ++i)
            take_in(tets_[cavity_tets_[k]].across[i] >> 2);
}

bool Mending::mend(int tet) {
    ++now_;
    cavity_tets_.clear();
    take_in(tet);
    for (std::size_t k = 0; k < cavity_tets_.size(); ++k)
        for (int i = 0; i < 4; ++i)
            if (is_broken(4 * cavity_tets_[k] + i))
                take_in(tets_[cavity_tets_[k]].across[i] >> 2);
    take_in_neighbours();
    for (int k = 0; k < kTries && cavity_tets_.size() <= kLargest; ++k) {
        more_.clear();
        if (refill())
            return true;
        const std::size_t before = cavity_tets_.size();
        for (const int t : more_)
            take_in(t);
        if (cavity_tets_.size() == before)
            return false;
    }
    return false;
}

bool Mending::refill() {
    collect_rim();
    if (rim_facets_.empty())
        return false;
    const auto all_round = [this] {
        for (const Rim &facet : rim_facets_)
            more_.push_back(facet.outside >> 2);
        return false;
    };
    if (!collect_vertices())
        return all_round();
    std::vector<Vec3> points;
    for (const int v : vertices_)
        points.push_back(points_[v]);
    if (have_twins(points))
        return false; // from scratch they are refused by their numbers
    const Mending made(points);
    if (!match(made))
        return false;
    if (!flood(made))
        return all_round();
    for (const Rim &facet : rim_facets_)
        if (turned_[facet.outside >> 2] || made.at_odds(facet.found >> 2, *this, facet.outside))
            more_.push_back(facet.outside >> 2);
    if (!more_.empty())
        return false;
    replace(made);
    return true;
}

/// False where they may all lie in a plane.
bool Mending::collect_vertices() {
    vertices_.clear();
    bool solid = false;
    for (const int t : cavity_tets_) {
        solid = solid || (!is_ghost(t) && !turned_[t]);
        for (const int v : tets_[t].corners)
            if (v >= 0)
                vertices_.push_back(v);
    }
    sort_unique(vertices_);
    return solid;
}

void Mending::collect_rim() {
    rim_facets_.clear();
    for (const int t : cavity_tets_)
        for (int i = 0; i < 4; ++i)
            if (const int outside = tets_[t].across[i]; stamp_[outside >> 2] != now_)
                rim_facets_.push_back({key_of(tets_[t].corners, i), outside});
    std::sort(rim_facets_.begin(), rim_facets_.end(),
              [](const Rim &a, const Rim &b) { return a.key.vertices < b.key.vertices; });
}

bool Mending::match(const Mending &made) {
    stop_.assign(4 * made.tets_.size(), 0);
    for (std::size_t t = 0; t < made.tets_.size(); ++t) {
        if (!made.alive(static_cast<int>(t)))
            continue;
        std::array<int, 4> corners = made.tets_[t].corners;
        for (int &v : corners)
            v = number_of(made, v);
        for (int i = 0; i < 4; ++i) {
            const Key key = key_of(corners, i);
            const auto at = std::lower_bound(rim_facets_.begin(), rim_facets_.end(), key.vertices,
                                             [](const Rim &facet, const auto &v) { return facet.key.vertices < v; });
            if (at == rim_facets_.end() || at->key.vertices != key.vertices)
                continue;
            const std::size_t facet = 4 * t + static_cast<std::size_t>(i);
            stop_[facet] = at->key.even == key.even ? 1 : 2;
            if (stop_[facet] == 1)
                at->found = static_cast<int>(facet);
        }
    }
    for (const Rim &facet : rim_facets_)
        if (facet.found < 0)
            more_.push_back(facet.outside >> 2);
    return more_.empty();
}

bool Mending::flood(const Mending &made) {
    inside_.assign(made.tets_.size(), 0);
    reached_.clear();
    const auto reach = [this](int tet) {
        if (!inside_[tet])
            reached_.push_back(tet);
        inside_[tet] = 1;
    };
    for (const Rim &facet : rim_facets_)
        reach(facet.found >> 2);
    for (std::size_t k = 0; k < reached_.size(); ++k)
        for (int i = 0; i < 4; ++i) {
            const char stop = stop_[4 * static_cast<std::size_t>(reached_[k]) + static_cast<std::size_t>(i)];
            if (stop == 2)
                return false;
            if (stop == 0)
                reach(made.tets_[reached_[k]].across[i] >> 2);
        }
    std::vector<char> used(vertices_.size(), 0);
    for (const int t : reached_)
        for (const int v : made.tets_[t].corners)
            if (v >= 0)
                used[made.order_[v]] = 1;
    return std::find(used.begin(), used.end(), 0) == used.end();
}

void Mending::replace(const Mending &made) {
    for (const int t : cavity_tets_) {
        tets_[t].corners[0] = kDead;
        unused_.push_back(t);
    }
    std::vector<int> name(made.tets_.size(), -1);
    for (const int t : reached_)
        name[t] = take_tet();
    turned_.resize(tets_.size(), 0);
    stamp_.resize(tets_.size(), 0);
    for (const int t : reached_) {
        const Tet &from = made.tets_[t];
        Tet &tet = tets_[name[t]];
        turned_[name[t]] = 0;
        for (int i = 0; i < 4; ++i) {
            tet.corners[i] = number_of(made, from.corners[i]);
            if (!stop_[4 * static_cast<std::size_t>(t) + static_cast<std::size_t>(i)])
                tet.across[i] = 4 * name[from.across[i] >> 2] + (from.across[i] & 3);
        }
    }
    for (const Rim &facet : rim_facets_) {
        const int inside = 4 * name[facet.found >> 2] + (facet.found & 3);
        across(inside) = facet.outside;
        across(facet.outside) = inside;
    }
}

MovingDelaunay::MovingDelaunay() = default;
MovingDelaunay::MovingDelaunay(MovingDelaunay &&) noexcept = default;
MovingDelaunay &MovingDelaunay::operator=(MovingDelaunay &&) noexcept = default;
MovingDelaunay::~MovingDelaunay() = default;

Triangulation MovingDelaunay::of(std::span<const Vec3> points, const Workers &workers) {
    if (!kept_ || kept_->count() != points.size() || !kept_->move(points, workers)) {
        kept_.reset();
        kept_ = std::make_unique<Mending>(points);
        ++made_;
    }
    return kept_->result();
}

} // namespace wct::delaunay
