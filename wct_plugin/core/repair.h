#pragma once

#include "operators.h"
#include "random.h"
#include "star_descent.h"

#include <utility>
#include <vector>

namespace wct {

/// Local repair of tets that fall short: tries operators on each, moves the vertices they touched, and keeps what
/// lowers the energy.
class Repair {
  public:
    enum Kind : unsigned { edges = 1, facets = 2, collapses = 4, splits = 8, inserts = 16, nudges = 32, chains = 64 };
    struct Recipe {
        unsigned operators; // bits of Kind
        double slack;       // how much worse an operator may leave things before relaxation
        int rounds, steps, flips;
    };
    /// From the cheapest to the widest choice of operators.
    static const Recipe recipes[3];

    Repair(TetComplex &complex, const SearchEnergy &energy, Operators &operators, StarDescent &descent, Random &random)
        : complex_(complex), energy_(energy), operators_(operators), descent_(descent), random_(random) {}

    /// One pass over the tets, worst first; those that are gone or good by then are left out. Returns the changes kept.
    int pass(const Recipe &recipe, const std::vector<int> &tets);
    /// A random change of connectivity at t that need not be good.
    bool random_operator(int t, double slack);
    /// Flips that lower the energy, round the given vertices.
    void flip_round(const std::vector<int> &vertices);

  private:
    bool attempt(unsigned kind, int variant, int t, double slack);
    bool chain(int t);
    void relax_touched(const Recipe &recipe);

    TetComplex &complex_;
    const SearchEnergy &energy_;
    Operators &operators_;
    StarDescent &descent_;
    Random &random_;
    std::vector<std::pair<double, int>> order_;
    std::vector<std::pair<unsigned, int>> tries_;
};

} // namespace wct
