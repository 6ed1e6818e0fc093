#include "sampling/pinch_mending.h"

#include "base/disjoint_sets.h"
#include "base/sort_unique.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace wct::sampling {

namespace {

constexpr std::size_t kLargest = 12; // tets that change sides at once
constexpr double kFlat = 1e-3;       // volume per cube of the size below which no tet is taken in
constexpr double kLong = 2.5;        // edge per size beyond which a tet is no matter of two sheets, but of the shape

/// Per vertex of the reference, whether triangles meet there that are not joined across edges.
std::vector<char> touching_vertices(const domain::SurfaceData &data) {
    std::vector<std::vector<int>> around(data.points.size());
    for (std::size_t t = 0; t < data.triangles.size(); ++t)
        for (const int v : data.triangles[t])
            around[v].push_back(static_cast<int>(t));
    std::vector<char> touching(data.points.size(), 0);
    for (const int v : data.corners) {
        std::vector<std::pair<int, int>> rim; // (other end of an edge at v, triangle)
        for (std::size_t k = 0; k < around[v].size(); ++k)
            for (const int w : data.triangles[around[v][k]])
                if (w != v)
                    rim.emplace_back(w, static_cast<int>(k));
        std::sort(rim.begin(), rim.end());
        DisjointSets fans(around[v].size());
        for (std::size_t k = 1; k < rim.size(); ++k)
            if (rim[k].first == rim[k - 1].first)
                fans.join(rim[k].second, rim[k - 1].second);
        touching[v] = fans.count() > 1;
    }
    return touching;
}

class Mender {
  public:
    Mender(const Cloud &cloud, RestrictedDelaunay &complex) : cloud_(cloud), complex_(complex), stars_(cloud.count()) {
        for (std::size_t t = 0; t < complex.all.tets.size(); ++t)
            for (const int v : complex.all.tets[t])
                stars_[v].push_back(static_cast<int>(t));
    }

    /// Make the change at v that mends most; false if none mends anything.
    bool mend(int v) {
        Change best;
        for (const auto &tets : candidates(v))
            for (const int region : regions_beside(tets)) {
                const Change change = judge(tets, region);
                if (change.gain > 0 &&
                    (change.gain > best.gain || (change.gain == best.gain && change.size < best.size)))
                    best = change;
            }
        for (const int t : best.tets)
            complex_.region[t] = best.region;
        return best.gain > 0;
    }

    /// How far the surfaces at v are from a disk each: edges that other than two facets share, fans beyond the first;
    /// more than anything else if v would be left bare, or lie open inside.
    int defect(int v) const {
        struct Use {
            int region, other, facet;
            auto operator<=>(const Use &) const = default;
        };
        constexpr int kNever = 1000;
        std::vector<Use> uses;
        int facets = 0;
        bool used = false;
        for (const int t : stars_[v]) {
            if (complex_.region[t] < 0)
                continue;
            used = true;
            for (int i = 0; i < 4; ++i) {
                if (complex_.all.tets[t][i] == v || complex_.beyond(t, i) == complex_.region[t])
                    continue;
                for (const int w : complex_.facet(t, i))
                    if (w != v)
                        uses.push_back({complex_.region[t], w, facets});
                ++facets;
            }
        }
        if (!used || (cloud_.role[v] == Stratum::interior && facets > 0))
            return kNever;
        std::sort(uses.begin(), uses.end());
        DisjointSets fans(static_cast<std::size_t>(facets));
        int wrong = 0, regions = 0;
        for (std::size_t k = 0; k < uses.size();) {
            std::size_t end = k + 1;
            while (end < uses.size() && uses[end].region == uses[k].region && uses[end].other == uses[k].other)
                ++end;
            regions += k == 0 || uses[k].region != uses[k - 1].region;
            wrong += end - k != 2;
            for (std::size_t j = k + 1; j < end; ++j)
                fans.join(uses[j].facet, uses[k].facet);
            k = end;
        }
        return wrong + fans.count() - regions;
    }

  private:
    struct Change {
        std::vector<int> tets;
        int region = -1;
        int gain = 0;
        double size = 0.0;
    };

    /// Pieces of v's star, and of the rings of its edges, that lie on one side and are small enough to change it.
    std::vector<std::vector<int>> candidates(int v) const {
        std::vector<std::vector<int>> pieces;
        std::vector<int> others;
        for (const int t : stars_[v]) {
            pieces.push_back({t});
            for (const int w : complex_.all.tets[t])
                if (w != v)
                    others.push_back(w);
        }
        add_pieces(stars_[v], v, v, pieces);
        sort_unique(others);
        for (const int w : others) {
            std::vector<int> ring;
            std::copy_if(stars_[v].begin(), stars_[v].end(), std::back_inserter(ring), [&](int t) {
                const auto &tet = complex_.all.tets[t];
                return std::find(tet.begin(), tet.end(), w) != tet.end();
            });
            add_pieces(ring, v, w, pieces);
        }
        std::erase_if(pieces, [&](const std::vector<int> &tets) {
            return tets.size() > kLargest || std::any_of(tets.begin(), tets.end(), [&](int t) { return !free(t); });
        });
        return pieces;
    }

    /// The tets joined across facets at both v and w to others of their region.
    void add_pieces(const std::vector<int> &tets, int v, int w, std::vector<std::vector<int>> &pieces) const {
        DisjointSets joined(tets.size());
        for (std::size_t k = 0; k < tets.size(); ++k)
            for (int i = 0; i < 4; ++i) {
                const int at = complex_.all.tets[tets[k]][i];
                if (at == v || at == w || complex_.beyond(tets[k], i) != complex_.region[tets[k]])
                    continue;
                const auto next = std::find(tets.begin(), tets.end(), complex_.all.neighbours[tets[k]][i]);
                if (next != tets.end())
                    joined.join(static_cast<int>(k), static_cast<int>(next - tets.begin()));
            }
        for (std::size_t k = 0; k < tets.size(); ++k) {
            if (joined.find(static_cast<int>(k)) != static_cast<int>(k))
                continue;
            std::vector<int> piece;
            for (std::size_t j = 0; j < tets.size(); ++j)
                if (joined.find(static_cast<int>(j)) == static_cast<int>(k))
                    piece.push_back(tets[j]);
            if (piece.size() > 1)
                pieces.push_back(std::move(piece));
        }
    }

    double volume(int t) const {
        const auto &[a, b, c, d] = complex_.all.tets[t];
        const auto &at = cloud_.points;
        return std::fabs(six_volumes(at[a], at[b], at[c], at[d])) / 6.0;
    }

    /// May this tet change sides? Interior points would come to light, flat tets would be of no use, and one that spans
    /// the space between two limbs would be a web between them.
    bool free(int t) const {
        const auto &tet = complex_.all.tets[t];
        double size = 0.0;
        for (const int v : tet) {
            if (cloud_.role[v] == Stratum::interior)
                return false;
            size += 0.25 * cloud_.size[v];
        }
        for (const auto &[i, j] : kEdges)
            if (norm(cloud_.points[tet[j]] - cloud_.points[tet[i]]) > kLong * size)
                return false;
        return complex_.region[t] >= 0 || volume(t) > kFlat * size * size * size;
    }

    std::vector<int> regions_beside(const std::vector<int> &tets) const {
        std::vector<int> regions;
        for (const int t : tets)
            for (int i = 0; i < 4; ++i)
                if (complex_.beyond(t, i) != complex_.region[t])
                    regions.push_back(complex_.beyond(t, i));
        sort_unique(regions);
        return regions;
    }

    Change judge(const std::vector<int> &tets, int region) {
        Change change{tets, region};
        std::vector<int> touched;
        for (const int t : tets) {
            touched.insert(touched.end(), complex_.all.tets[t].begin(), complex_.all.tets[t].end());
            change.size += volume(t);
        }
        sort_unique(touched);
        const auto total = [&] {
            int sum = 0;
            for (const int v : touched)
                sum += defect(v);
            return sum;
        };
        const int before = total();
        const int old = complex_.region[tets.front()];
        for (const int t : tets)
            complex_.region[t] = region;
        change.gain = before - total();
        for (const int t : tets)
            complex_.region[t] = old;
        return change;
    }

    const Cloud &cloud_;
    RestrictedDelaunay &complex_;
    std::vector<std::vector<int>> stars_;
};

} // namespace

Flaws mend_pinches(const Cloud &cloud, const domain::Reference &reference, RestrictedDelaunay &complex, Flaws flaws) {
    const std::vector<char> touching = touching_vertices(reference.data());
    const auto meant = [&](int v) { return cloud.role[v] == Stratum::corner && touching[cloud.label[v]]; };
    if (std::all_of(flaws.pinched.begin(), flaws.pinched.end(), meant))
        return flaws;
    Mender mender(cloud, complex);
    for (bool again = true; again;) { // ends: each change lowers the sum of the defects
        again = false;
        for (const int v : flaws.pinched)
            while (!meant(v) && mender.defect(v) > 0 && mender.mend(v))
                again = true;
        flaws = find_flaws(cloud, complex);
    }
    return flaws;
}

} // namespace wct::sampling
