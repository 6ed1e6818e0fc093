#pragma once

#include "operators.h"
#include "random.h"
#include "star_descent.h"

#include <functional>
#include <vector>

namespace wct {

struct SearchOptions {
    bool acute = true;    // aim at CWC; otherwise at 3WC alone
    double margin = 0.02; // clearance in h/R and cosine the polish aims at
    bool flip_surface = true;
    bool split_surface = true;
    int passes = 12;    // greatest number of sweeps over all tets that fall short
    long kicks = 20000; // greatest number of tries of the iterated local search
    std::uint64_t seed = 0;
};

struct SearchOutcome {
    int bad = 0;
    int passes = 0;
    long kicks = 0;
    long accepted = 0;
    long evaluations = 0;
    bool stopped = false;
};

/// Called now and then with the part done (of the present phase) and the number of bad tets; false stops the search.
using SearchProgress = std::function<bool(const char *phase, double done, int bad)>;

/// Makes a mesh well-centered by local changes: passes over the tets that fall short, each trying operators and keeping
/// what lowers the energy; then iterated local search (Lourenço, Martin, Stützle 2003) at what is left: kick a
/// neighbourhood, optimise it again, keep the result unless it got worse; then a polish that widens the margins. Bad
/// tets never increase from phase to phase, and every intermediate state is a valid mesh.
class Search {
  public:
    Search(TetComplex &complex, const SurfaceGuide &guide, const SearchOptions &options);

    SearchOutcome run(const SearchProgress &progress);

  private:
    struct Recipe {
        unsigned operators; // bits of Kind
        double slack;       // how much worse an operator may leave things before relaxation
        int rounds, steps, flips;
    };
    enum Kind : unsigned { edges = 1, facets = 2, collapses = 4, splits = 8, inserts = 16, nudges = 32, chains = 64 };
    struct Kick {
        double radius, sigma;
        int operators;
        double slack;
    };

    void adopt(const SearchForm &form);
    int count_bad() const;
    void collect_bad(std::vector<int> &out) const;
    int pass(const Recipe &recipe, std::vector<std::pair<double, int>> &order);
    int sweep(const Recipe &recipe);
    int sweep_near(const Recipe &recipe, const Vec3 &center, double radius, int vertex);
    bool attempt(unsigned kind, int variant, int t, double slack);
    bool chain(int t);
    void relax_touched(const Recipe &recipe);
    void flip_round(const std::vector<int> &vertices);
    void ball(const Vec3 &center, double radius, int vertex, std::vector<int> &out);
    void kick(int t, const Kick &kick);
    bool random_operator(int t, double slack);
    bool try_kick(int t, bool few);
    bool kick_until_good(const SearchProgress &progress, const char *phase, long kicks);
    void polish();
    double clearance() const;

    TetComplex &complex_;
    const SurfaceGuide &guide_;
    SearchOptions options_;
    SearchEnergy energy_;
    SurfaceWatch watch_;
    Operators operators_;
    StarDescent descent_;
    Random random_;
    std::vector<int> marks_;
    int mark_ = 0;
    std::vector<std::pair<double, int>> order_;
    SearchOutcome outcome_;
};

} // namespace wct
