#include "delaunay/flat_tets.h"

#include "base/cells.h"
#include "delaunay/corners.h"
#include "geometry/circumspheres.h"
#include "geometry/dihedral_angles.h"
#include "geometry/predicates.h"

#include <algorithm>
#include <array>
#include <utility>

namespace wct::delaunay {

namespace {

constexpr std::size_t kMost = 4; // tets round an edge that is taken out
constexpr double kInside = 1e-9; // of a sphere's radius that a point may be inside of it
constexpr int kPasses = 3;       // a flip may free the next one

/// Across a facet of what is flipped: the tet there, -1 on the hull, and its corner beyond.
struct Side {
    Facet facet; // ascending
    int tet;
    int corner;
};

class Flips {
  public:
    Flips(Triangulation &all, std::vector<int> &label, std::span<const Vec3> points)
        : all_(all), label_(label), points_(points), gone_(all.tets.size(), 0) {}

    void run(double sharpest) {
        bool changed = true;
        for (int pass = 0; pass < kPasses && changed; ++pass) {
            changed = false;
            for (std::size_t t = 0; t < all_.tets.size(); ++t)
                if (!gone_[t] && label_[t] >= 0 && angle(all_.tets[t]) < sharpest)
                    changed = take_out(static_cast<int>(t)) || make_way(static_cast<int>(t), sharpest) || changed;
        }
        drop_gone();
    }

  private:
    double angle(const Corners &tet) const {
        return geometry::smallest_dihedral({points_[tet[0]], points_[tet[1]], points_[tet[2]], points_[tet[3]]});
    }

    bool take_out(int t) {
        const Corners tet = all_.tets[t];
        return std::any_of(std::begin(kEdges), std::end(kEdges),
                           [&](const auto &e) { return flip(t, tet[e[0]], tet[e[1]], 4.0); });
    }

    /// Tets beside t may leave no way to fill what is round its edges, as three rectangles of a prism do that are cut
    /// one after the other in a circle: flip them, though nothing is won by it, until t can be taken out.
    bool make_way(int t, double sharpest) {
        std::vector<int> beside;
        for (const int next : all_.neighbours[t])
            if (next >= 0) {
                beside.push_back(next);
                beside.insert(beside.end(), all_.neighbours[next].begin(), all_.neighbours[next].end());
            }
        for (const int other : beside) {
            if (other < 0 || other == t || gone_[other] || label_[other] != label_[t])
                continue;
            const Corners tet = all_.tets[other];
            for (const auto &e : kEdges) {
                const int a = tet[e[0]], b = tet[e[1]];
                if (place_of(all_.tets[t], a) < 4 && place_of(all_.tets[t], b) < 4)
                    continue; // an edge of t
                if (flip(other, a, b, sharpest)) {
                    if (take_out(t))
                        return true;
                    break;
                }
            }
        }
        return false;
    }

    /// The tets round the edge (a, b) of tet t, in turn, and the corners of its link; false if there are too many, the
    /// edge is on the hull or the labels differ.
    bool walk(int t, int a, int b) {
        ring_.clear();
        link_.clear();
        int from = -1, to = -1;
        for (const int v : all_.tets[t])
            if (v != a && v != b)
                (from < 0 ? from : to) = v;
        const int first = from;
        for (int at = t;;) {
            ring_.push_back(at);
            link_.push_back(from);
            const int next = all_.neighbours[at][place_of(all_.tets[at], from)];
            if (next < 0 || label_[next] != label_[t] || ring_.size() > kMost)
                return false;
            if (next == t)
                return to == first;
            const Corners &tet = all_.tets[next];
            from = std::exchange(
                to, *std::find_if(tet.begin(), tet.end(), [&](int v) { return v != a && v != b && v != to; }));
            at = next;
        }
    }

    /// Take the edge (a, b) of t out, if what comes is less flat than what goes or than `enough`.
    bool flip(int t, int a, int b, double enough) {
        if (!walk(t, a, b) || ring_.size() < 3)
            return false;
        const auto &r = link_;
        if (geometry::orient3d(points_[a], points_[b], points_[r[0]], points_[r[1]]) < 0)
            std::swap(a, b); // the link now turns to the left as seen from b
        double flattest = enough;
        for (const int at : ring_)
            flattest = std::min(flattest, angle(all_.tets[at]));
        look_around(a, b);
        std::vector<Corners> best;
        for (std::size_t k = 0; k + 2 < r.size(); ++k) { // triangles from corner k of the link to all edges of it
            std::vector<Corners> made;
            double least = 4.0;
            for (std::size_t i = 1; i + 1 < r.size(); ++i) {
                const int x = r[k], y = r[(k + i) % r.size()], z = r[(k + i + 1) % r.size()];
                for (const Corners &tet : {Corners{x, y, z, b}, Corners{x, z, y, a}}) {
                    made.push_back(tet);
                    least = std::min(least, fits(tet, a, b) ? angle(tet) : -1.0);
                }
            }
            if (least > flattest) {
                flattest = least;
                best = made;
            }
        }
        if (best.empty())
            return false;
        put(best);
        return true;
    }

    /// What is across the outer facets of the ring.
    void look_around(int a, int b) {
        sides_.clear();
        for (const int at : ring_)
            for (const int end : {a, b}) {
                const int i = place_of(all_.tets[at], end), over = all_.neighbours[at][i];
                Side side{{}, over, -1};
                int n = 0;
                for (const int v : all_.tets[at])
                    if (v != end)
                        side.facet[n++] = v;
                std::sort(side.facet.begin(), side.facet.end());
                if (over >= 0)
                    side.corner = beyond(over, side.facet);
                sides_.push_back(side);
            }
    }

    int beyond(int t, const Facet &facet) const {
        const Corners &tet = all_.tets[t];
        return *std::find_if(tet.begin(), tet.end(),
                             [&](int v) { return !std::binary_search(facet.begin(), facet.end(), v); });
    }

    /// Is a tet positive, and its sphere empty of the points around?
    bool fits(const Corners &tet, int a, int b) const {
        const auto &[p, q, r, s] = tet;
        if (geometry::orient3d(points_[p], points_[q], points_[r], points_[s]) <= 0)
            return false;
        const geometry::Sphere ball = geometry::circumsphere(points_[p], points_[q], points_[r], points_[s]);
        const auto outside = [&](int v) {
            return place_of(tet, v) < 4 || norm(points_[v] - ball.center) >= (1.0 - kInside) * ball.radius;
        };
        return outside(a) && outside(b) && std::all_of(link_.begin(), link_.end(), outside) &&
               std::all_of(sides_.begin(), sides_.end(),
                           [&](const Side &side) { return side.tet < 0 || outside(side.corner); });
    }

    /// The new tets take the places of the ring's; what is left of those is gone.
    void put(const std::vector<Corners> &made) {
        for (std::size_t k = made.size(); k < ring_.size(); ++k)
            gone_[ring_[k]] = 1;
        std::vector<std::pair<Facet, std::array<int, 2>>> halves; // with the tet and the corner across
        for (std::size_t k = 0; k < made.size(); ++k) {
            all_.tets[ring_[k]] = made[k];
            for (int i = 0; i < 4; ++i)
                halves.push_back({sorted(inward_facet(made[k], i)), {ring_[k], i}});
        }
        for (const auto &[facet, half] : halves) {
            const auto &[tet, i] = half;
            const auto side =
                std::find_if(sides_.begin(), sides_.end(), [&](const Side &s) { return s.facet == facet; });
            if (side != sides_.end()) {
                all_.neighbours[tet][i] = side->tet;
                if (side->tet >= 0)
                    all_.neighbours[side->tet][place_of(all_.tets[side->tet], side->corner)] = tet;
                continue;
            }
            for (const auto &[other, back] : halves)
                if (other == facet && back[0] != tet)
                    all_.neighbours[tet][i] = back[0];
        }
    }

    void drop_gone() {
        std::vector<int> place(gone_.size(), -1);
        std::size_t next = 0;
        for (std::size_t t = 0; t < gone_.size(); ++t)
            if (!gone_[t]) {
                all_.tets[next] = all_.tets[t];
                all_.neighbours[next] = all_.neighbours[t];
                label_[next] = label_[t];
                place[t] = static_cast<int>(next++);
            }
        all_.tets.resize(next);
        all_.neighbours.resize(next);
        label_.resize(next);
        for (auto &row : all_.neighbours)
            for (int &other : row)
                other = other < 0 ? -1 : place[other];
    }

    Triangulation &all_;
    std::vector<int> &label_;
    std::span<const Vec3> points_;
    std::vector<char> gone_;
    std::vector<int> ring_, link_; // round an edge: tets, and corners, tet k between corners k and k + 1
    std::vector<Side> sides_;
};

} // namespace

void remove_flat(Triangulation &all, std::vector<int> &label, std::span<const Vec3> points, double sharpest) {
    Flips(all, label, points).run(sharpest);
}

} // namespace wct::delaunay
