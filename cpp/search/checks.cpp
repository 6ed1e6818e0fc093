#include "search/checks.h"

#ifdef WCT_CHECKS

#include "geometry/piece_tree.h"
#include "geometry/predicates.h"
#include "search/surface_guide.h"
#include "search/tet_complex.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

namespace wct::search {

namespace {

constexpr long kAll = 1000; // commits from one look at all of the mesh to the next

int orientation(const TetComplex &complex, int a, int b, int c, int d) {
    return geometry::orient3d(complex.point(a), complex.point(b), complex.point(c), complex.point(d));
}

/// What is looked at, and who is to blame.
class Inspection {
  public:
    Inspection(const TetComplex &complex, bool two_sided, const std::vector<const char *> &done)
        : complex_(complex), two_sided_(two_sided), done_(done) {}

    void tet(int t) const {
        const Tet &tet = complex_.tet(t);
        expect(orientation(complex_, tet[0], tet[1], tet[2], tet[3]) > 0, "not positive: tet", {t}, tet);
        expect(std::isfinite(complex_.energy(t)), "no finite energy: tet", {t}, tet);
        for (const int v : tet)
            expect(std::count(complex_.star(v).begin(), complex_.star(v).end(), t) == 1, "not in the star of", {v},
                   tet);
        for (int i = 0; i < 4; ++i)
            facet(t, i);
    }

    void star(int v) const {
        for (const int t : complex_.star(v))
            expect(complex_.alive(t) && complex_.has(t, v), "in the star of a vertex that is none of it: tet", {t, v});
    }

    void surface_facet(const Facet &key) const { expect(complex_.has_cell(key), "of no tet: surface facet", {}, key); }
    void crease(const Edge &key) const { expect(complex_.has_cell(key), "of no tet: crease", {}, key); }

    /// What the tets that went were at has others there.
    void gone(const Tet &tet) const {
        for (const auto &f : kFacets)
            if (complex_.is_surface(tet[f[0]], tet[f[1]], tet[f[2]]))
                surface_facet(sorted(tet[f[0]], tet[f[1]], tet[f[2]]));
        for (const auto &e : kEdges)
            if (complex_.is_crease(tet[e[0]], tet[e[1]]))
                crease(sorted(tet[e[0]], tet[e[1]]));
    }

    template <std::size_t n = 0>
    void expect(bool holds, const char *what, std::initializer_list<int> numbers,
                const std::array<int, n> &cell = {}) const {
        if (holds)
            return;
        std::ostringstream text;
        text << what;
        for (const int number : numbers)
            text << ' ' << number;
        for (std::size_t k = 0; k < n; ++k)
            text << (k ? ", " : " (") << cell[k] << (k + 1 == n ? ")" : "");
        text << "; since the mark:";
        for (const char *name : done_)
            text << ' ' << name;
        throw std::logic_error("the search broke its mesh: " + text.str());
    }

  private:
    void facet(int t, int i) const {
        const Tet &tet = complex_.tet(t);
        const auto [a, b, c] = inward_facet(tet, i);
        const Facet key = sorted(a, b, c);
        int others = 0, other = -1;
        for (const int s : complex_.star(a))
            if (s != t && complex_.has(s, b) && complex_.has(s, c)) {
                ++others;
                other = s;
            }
        expect(others <= 1, "more than two tets at facet", {}, key);
        if (others == 0 || complex_.region(other) != complex_.region(t))
            expect(complex_.is_surface(a, b, c), "not in the surface map: facet", {}, key);
        if (others == 0 || !two_sided_)
            return;
        int apex = -1;
        for (const int v : complex_.tet(other))
            if (v != a && v != b && v != c)
                apex = v;
        expect(orientation(complex_, a, b, c, apex) < 0, "on one side of a facet they share: tets", {t, other}, key);
    }

    const TetComplex &complex_;
    bool two_sided_;
    const std::vector<const char *> &done_;
};

} // namespace

void CommitChecks::start(const TetComplex &complex) {
    on_ = true;
    two_sided_ = true;
    try {
        check_all(complex);
    } catch (const std::logic_error &) { // what came in overlaps itself, or else the second look finds what is wrong
        two_sided_ = false;
        check_all(complex);
    }
}

void CommitChecks::did(const char *name) {
    if (!marks_.empty())
        done_.push_back(name);
}

void CommitChecks::rollback() {
    done_.resize(marks_.back());
    marks_.pop_back();
}

void CommitChecks::commit(const TetComplex &complex) {
    if (on_) {
        if (++commits_ % kAll == 0)
            check_all(complex);
        else
            check_changed(complex);
    }
    marks_.pop_back();
    if (marks_.empty())
        done_.clear();
}

void CommitChecks::check_changed(const TetComplex &complex) const {
    const std::vector<const char *> done(done_.begin() + static_cast<std::ptrdiff_t>(marks_.back()), done_.end());
    const Inspection look(complex, two_sided_, done);
    std::vector<int> changed;
    complex.changed(changed);
    std::set<int> vertices, tets;
    for (const int t : changed) {
        vertices.insert(complex.tet(t).begin(), complex.tet(t).end());
        if (!complex.alive(t)) // its corners stay on record until no rollback can ask for them
            look.gone(complex.tet(t));
    }
    for (const int v : vertices) {
        look.star(v);
        tets.insert(complex.star(v).begin(), complex.star(v).end());
    }
    for (const int t : tets)
        look.tet(t);
}

void CommitChecks::check_all(const TetComplex &complex) const {
    const Inspection look(complex, two_sided_, done_);
    std::size_t count = 0;
    for (std::size_t k = 0; k < complex.tet_slots(); ++k)
        if (const int t = static_cast<int>(k); complex.alive(t)) {
            look.tet(t);
            ++count;
        }
    look.expect(count == complex.tets(), "miscounted tets:", {static_cast<int>(count)});
    for (std::size_t v = 0; v < complex.vertex_slots(); ++v)
        look.star(static_cast<int>(v));
    for (const auto &[key, patch] : complex.sorted_surface())
        look.surface_facet(key);
    for (const auto &[key, curve] : complex.creases())
        look.crease(key);
}

void CommitChecks::end(const TetComplex &complex, const SurfaceGuide &guide) const {
    constexpr double rounding = 1e-6;
    check_all(complex);
    const Inspection look(complex, two_sided_, done_);
    double sum = 0.0;
    for (std::size_t k = 0; k < complex.tet_slots(); ++k)
        if (const int t = static_cast<int>(k); complex.alive(t))
            sum += complex.energy(t);
    look.expect(std::abs(sum - complex.total()) <= rounding * (1.0 + sum), "the energies' sum is off", {});
    for (const auto &[key, patch] : complex.sorted_surface()) {
        const bool over = complex.over(key) > 0.0;
        const auto corners = complex.corners(key);
        for (int l = complex.facet(key).landmark; l >= 0; l = complex.next_landmark(l)) {
            look.expect(complex.landmark_owner(l) == key, "another facet owns landmark", {l}, key);
            look.expect(guide.landmarks()[l].patch == patch, "of another patch is the owner of landmark", {l}, key);
            const Vec3 &point = guide.landmarks()[l].point;
            look.expect(over || guide.strict(l) * norm(point - geometry::closest_on(corners, point)) <=
                                    guide.tolerance() * (1.0 + rounding),
                        "too far from the facet that owns it: landmark", {l}, key);
        }
    }
}

} // namespace wct::search

#endif
