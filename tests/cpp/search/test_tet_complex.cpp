#include "search/tet_complex.h"

#include "base/random.h"
#include "support/bench.h"
#include "support/state.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

namespace wct::tests {

using search::TetComplex;

namespace {

/// Random edits of every kind that the journal knows. They need not make sense as a mesh.
class Editor {
  public:
    Editor(TetComplex &complex, Random &random) : complex_(complex), random_(random) {}

    void edit() {
        switch (random_.below(12)) {
        case 0:
            complex_.add_vertex({random_.normal3(), Stratum::interior, -1, random_.uniform(), 0.9});
            break;
        case 1:
            complex_.move(any_vertex(), random_.normal3());
            break;
        case 2:
        case 3:
            add_tet();
            break;
        case 4:
            if (const int t = any_tet(); t >= 0)
                complex_.remove_tet(t);
            break;
        case 5:
            if (const int t = any_tet(); t >= 0)
                complex_.set_energy(t, random_.uniform());
            break;
        case 6:
            add_facet();
            break;
        case 7:
            replace_facet();
            break;
        case 8:
            if (const auto key = any_facet())
                complex_.set_over(*key, random_.coin() ? 0.0 : random_.uniform());
            break;
        case 9:
            complex_.set_hint(any_vertex(), random_.below(100));
            break;
        case 10:
            if (const auto key = any_facet()) {
                search::SurfaceHints hints;
                hints.fill(random_.below(100));
                complex_.set_hints(*key, hints);
            }
            break;
        default:
            edit_crease();
        }
    }

  private:
    int any_vertex() { return random_.below(static_cast<int>(complex_.vertex_slots())); }

    int any_tet() {
        for (int k = 0; k < 50; ++k)
            if (const int t = random_.below(static_cast<int>(complex_.tet_slots())); complex_.alive(t))
                return t;
        return -1;
    }

    std::optional<Facet> any_facet() {
        const auto all = complex_.sorted_surface();
        if (all.empty())
            return std::nullopt;
        return all[random_.below(static_cast<int>(all.size()))].first;
    }

    template <std::size_t n> std::array<int, n> distinct() {
        std::set<int> chosen;
        while (chosen.size() < n)
            chosen.insert(any_vertex());
        std::array<int, n> out;
        std::copy(chosen.begin(), chosen.end(), out.begin());
        return out;
    }

    void add_tet() { complex_.add_tet(distinct<4>(), random_.below(3), random_.uniform()); }

    std::optional<Facet> add_facet() {
        const Facet key = distinct<3>();
        for (const auto &[known, patch] : complex_.sorted_surface())
            if (known == key)
                return std::nullopt;
        complex_.add_facet(key, random_.below(4));
        return key;
    }

    /// A facet goes and hands what it owns to another, as it must.
    void replace_facet() {
        const auto gone = any_facet();
        const auto fresh = add_facet();
        if (!gone || !fresh)
            return;
        std::vector<int> landmarks;
        for (int l = complex_.facet(*gone).landmark; l >= 0; l = complex_.next_landmark(l))
            landmarks.push_back(l);
        for (const int l : landmarks)
            complex_.hand_landmark(l, *fresh);
        complex_.remove_facet(*gone);
    }

    void edit_crease() {
        if (complex_.creases().empty() || random_.coin()) {
            const Edge key = distinct<2>();
            if (!complex_.creases().contains(key))
                complex_.add_crease(key, random_.below(5));
            return;
        }
        std::vector<std::pair<Edge, int>> all(complex_.creases().begin(), complex_.creases().end());
        std::sort(all.begin(), all.end());
        complex_.remove_crease(all[random_.below(static_cast<int>(all.size()))].first);
    }

    TetComplex &complex_;
    Random &random_;
};

TetComplex edited_cube() {
    const Body body = cube(2, 0.1, 3);
    TetComplex complex = complex_of(body);
    for (int l = 0; l < 20; ++l) {
        const auto &f = body.facets[l];
        complex.add_landmark(sorted(f[0], f[1], f[2]));
        complex.add_landmark(sorted(f[0], f[1], f[2]));
    }
    return complex;
}

} // namespace

TEST_CASE("TetComplex: rollback gives back every bit, whatever was changed and however marks nest") {
    Random random(11);
    for (int round = 0; round < 60; ++round) {
        TetComplex complex = edited_cube();
        Editor editor(complex, random);
        for (int k = 0; k < 10; ++k) // slots without tets are there from the start
            editor.edit();
        std::vector<State> marks;
        for (int step = 0; step < 150; ++step) {
            const int choice = random.below(12);
            if (choice == 0 && marks.size() < 5) {
                complex.mark();
                marks.emplace_back(complex);
            } else if (choice == 1 && !marks.empty()) {
                complex.rollback();
                REQUIRE(difference(marks.back(), State(complex)) == "");
                marks.pop_back();
            } else if (choice == 2 && !marks.empty()) {
                const State before(complex);
                complex.commit(); // the changes stay, for the mark around them to undo
                REQUIRE(difference(before, State(complex)) == "");
                marks.pop_back();
            } else {
                editor.edit();
            }
        }
        while (!marks.empty()) {
            complex.rollback();
            REQUIRE(difference(marks.back(), State(complex)) == "");
            marks.pop_back();
        }
    }
}

TEST_CASE("TetComplex: after a rollback the same edits lead to the same bits as if nothing had been") {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        TetComplex complex = edited_cube();
        Random before(seed);
        for (int k = 0; k < 30; ++k)
            Editor(complex, before).edit();
        TetComplex other = complex;
        complex.mark();
        for (int k = 0; k < 60; ++k)
            Editor(complex, before).edit();
        complex.rollback();
        Random first(seed + 100), second(seed + 100);
        for (int k = 0; k < 60; ++k) {
            Editor(complex, first).edit();
            Editor(other, second).edit();
        }
        REQUIRE(difference(State(complex), State(other)) == "");
    }
}

TEST_CASE("TetComplex: a slot is given to another tet only once nobody can ask for the one that went") {
    TetComplex complex = edited_cube();
    const std::size_t slots = complex.tet_slots();
    const Tet gone = complex.tet(7);
    complex.mark();
    complex.remove_tet(7);
    const int fresh = complex.add_tet(gone, 1, 0.5);
    CHECK(fresh == static_cast<int>(slots));
    complex.commit();
    complex.mark();
    CHECK(complex.add_tet(complex.tet(8), 1, 0.5) == 7); // now it is free
    complex.rollback();
    CHECK_FALSE(complex.alive(7));
    CHECK(complex.add_tet(complex.tet(8), 1, 0.5) == 7);
}

TEST_CASE("TetComplex: gain and changed tell what happened since the last mark alone") {
    TetComplex complex = edited_cube();
    for (int t = 0; t < static_cast<int>(complex.tet_slots()); ++t)
        complex.set_energy(t, 0.25);
    complex.mark();
    complex.set_energy(3, 1.0);
    complex.mark();
    complex.set_energy(5, 2.0);
    complex.remove_tet(6);
    const int fresh = complex.add_tet(complex.tet(6), 0, 4.0);
    complex.set_energy(5, 3.0);
    std::vector<int> changed;
    complex.changed(changed);
    CHECK(changed == std::vector<int>{5, 6, fresh});
    CHECK(complex.gain() == doctest::Approx(2.75 - 0.25 + 4.0));
    complex.commit();
    complex.changed(changed);
    CHECK(changed == std::vector<int>{3, 5, 6, fresh});
    CHECK(complex.gain() == doctest::Approx(0.75 + 2.75 - 0.25 + 4.0));
    complex.rollback();
    CHECK(complex.energy(3) == 0.25);
    CHECK(complex.energy(5) == 0.25);
}

TEST_CASE("TetComplex: stars, facets, creases and tets across agree with the tets") {
    const Body body = cube(3, 0.2, 2, 1.0 / 3.0);
    const TetComplex complex = complex_of(body);
    REQUIRE(fault(complex) == "");
    std::vector<TetComplex::SurfaceAt> found;
    for (std::size_t k = 0; k < body.points.size(); ++k) {
        const int v = static_cast<int>(k);
        std::set<Facet> wanted, seen;
        for (const Facet &f : body.facets)
            if (std::find(f.begin(), f.end(), v) != f.end())
                wanted.insert(sorted(f[0], f[1], f[2]));
        complex.surface_at(v, found);
        for (const auto &[key, facet] : found)
            CHECK(seen.insert(key).second);
        CHECK(seen == wanted);
    }
    for (std::size_t k = 0; k < body.tets.size(); ++k) {
        const int t = static_cast<int>(k);
        for (int i = 0; i < 4; ++i) {
            const Tet &tet = complex.tet(t);
            const int a = tet[kFacets[i][0]], b = tet[kFacets[i][1]], c = tet[kFacets[i][2]];
            const int other = complex.across(t, a, b, c);
            if (other < 0) {
                CHECK(complex.patch_of(c, a, b) >= 0);
                continue;
            }
            CHECK(complex.across(other, c, b, a) == t);
            CHECK_FALSE(complex.has(other, tet[i]));
        }
    }
}

TEST_CASE("TetComplex: over counts facets beyond the tolerance, once for each tet at them") {
    const Body body = cube(2, 0.0, 1, 0.5);
    TetComplex complex = complex_of(body);
    const Facet key = [&] { // an interface facet: of two tets
        for (std::size_t k = 0; k < body.facets.size(); ++k)
            if (body.sides[body.patch[k]][1] >= 0)
                return sorted(body.facets[k][0], body.facets[k][1], body.facets[k][2]);
        return Facet{};
    }();
    complex.set_over(key, 0.5);
    CHECK(complex.over_count() == 1);
    double sum = 0.0;
    for (std::size_t t = 0; t < complex.tet_slots(); ++t)
        sum += complex.over(complex.tet(static_cast<int>(t)));
    CHECK(sum == 2 * 1.5);
    complex.set_over(key, 0.0);
    CHECK(complex.over_count() == 0);
}

TEST_CASE("TetComplex: what is ruled out is every tet at the facet") {
    const Body body = cube(2, 0.0, 1);
    TetComplex complex = complex_of(body);
    const Facet key = sorted(body.facets[0][0], body.facets[0][1], body.facets[0][2]);
    CHECK_FALSE(complex.ruled_out(0));
    complex.rule_out(key);
    for (std::size_t k = 0; k < complex.tet_slots(); ++k) {
        const int t = static_cast<int>(k);
        CHECK(complex.ruled_out(t) == (complex.has(t, key[0]) && complex.has(t, key[1]) && complex.has(t, key[2])));
    }
}

TEST_CASE("TetComplex: sorted worst first, ties by number") {
    TetComplex complex = edited_cube();
    complex.set_energy(2, 1.0);
    complex.set_energy(4, 3.0);
    std::vector<int> tets{5, 4, 2, 1};
    complex.sort_worst_first(tets);
    CHECK(tets == std::vector<int>{4, 2, 1, 5});
}

} // namespace wct::tests
