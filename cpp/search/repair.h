#pragma once

#include "base/random.h"
#include "search/group_descent.h"
#include "search/operators.h"
#include "search/vertex_descent.h"

#include <optional>
#include <utility>
#include <vector>

namespace wct::search {

/// Local repair of bad tets: tries to move their neighbourhood, then operators, moves the vertices these touched, and
/// keeps what lowers the energy.
class Repair {
  public:
    enum Kind : unsigned {
        edges = 1,
        facets = 2,
        collapses = 4,
        splits = 8,
        inserts = 16,
        nudges = 32,
        chains = 64,
        groups = 128
    };
    struct Recipe {
        unsigned operators; // bits of Kind
        double slack;       // how much worse an operator may leave things before relaxation
        int rounds, steps, flips;
    };
    /// From the cheapest to the widest choice of operators.
    static const Recipe recipes[3];

    Repair(TetComplex &complex, const SearchEnergy &energy, Operators &operators, VertexDescent &descent,
           GroupDescent &group, Random &random)
        : complex_(complex), energy_(energy), operators_(operators), descent_(descent), group_(group), random_(random) {
    }

    /// One pass over the tets, worst first; those that are gone or good by then are left out.
    void pass(const Recipe &recipe, const std::vector<int> &tets);
    /// The same at one tet; true if anything was kept.
    bool improve(const Recipe &recipe, int t);
    /// A random change of connectivity at t that need not be good.
    bool random_operator(int t, double slack);
    /// A new vertex on a surface facet of t: where the facet is farthest beyond the tolerance, or anywhere on it.
    std::optional<int> insert_on_facet(int t, double slack);
    /// Move there the vertex of the facet that is nearest instead; returns it. Between the two sides of a slot there is
    /// no room for one more.
    std::optional<int> snap(int t);
    /// Flips that lower the energy, round the given vertices.
    void flip_round(const std::vector<int> &vertices);

  private:
    bool attempt(unsigned kind, int variant, int t, double slack);
    bool chain(int t);
    bool insert_inside(int t, bool anywhere, double slack);
    void relax_touched(const Recipe &recipe);

    TetComplex &complex_;
    const SearchEnergy &energy_;
    Operators &operators_;
    VertexDescent &descent_;
    GroupDescent &group_;
    Random &random_;
    std::vector<int> order_;
    std::vector<std::pair<unsigned, int>> tries_, row_;
};

} // namespace wct::search
