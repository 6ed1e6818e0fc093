#include "search/repair.h"

#include "base/sort_unique.h"

#include <algorithm>
#include <array>

namespace wct::search {

namespace {
constexpr double kAny = 1e-5; // an energy drop worth keeping
// After the first round of descent an operator is hopeless that has raised the energy by more than this, and by more
// than this share of what it raised it by at once.
constexpr double kHopeless = 0.05;
constexpr double kStays = 0.7;
// Descent ends where a round gains less than this share of all so far, and than this.
constexpr double kSlow = 1e-4;
constexpr double kNothing = 1e-10;
constexpr double kMiddle = 0.3; // what each corner's weight in a random point has beside up to 1 by chance
constexpr double kNudge = 0.15; // deviation of random steps, in sizes
} // namespace

const Repair::Recipe Repair::recipes[3] = {
    {edges | facets | collapses | groups, 1.0, 2, 4, 1},
    {edges | facets | collapses | groups | inserts | nudges | splits, 1.0, 2, 4, 1},
    {edges | facets | collapses | groups | inserts | nudges | splits | chains, 2.0, 3, 4, 2}};

void Repair::flip_round(const std::vector<int> &vertices) {
    std::vector<int> tets;
    for (int v : vertices)
        for (int t : complex_.star(v))
            if (complex_.energy(t) > 0.0)
                tets.push_back(t);
    sort_unique(tets);
    constexpr double lower = -1e-9;
    for (int t : tets) {
        if (!complex_.alive(t) || complex_.energy(t) <= 0.0)
            continue;
        const Tet tet = complex_.tet(t);
        bool done = false;
        for (int e = 0; e < 6 && !done; ++e)
            done = operators_.remove_edge(tet[kEdges[e][0]], tet[kEdges[e][1]], lower);
        for (int i = 0; i < 4 && !done; ++i)
            done = operators_.flip_23(t, i, lower);
    }
}

void Repair::relax_touched(const Recipe &recipe) {
    std::vector<int> vertices = operators_.touched;
    const double after_operator = complex_.gain();
    for (int round = 0; round < recipe.rounds; ++round) {
        const double before = complex_.total();
        for (int v : vertices)
            descent_.relax(v, recipe.steps);
        if (round == 0 && complex_.gain() > std::max(kHopeless, kStays * after_operator))
            return; // hopeless: the first round brings most of what there is to gain
        if (round < recipe.flips) {
            operators_.touched = vertices;
            flip_round(vertices);
            vertices = operators_.touched;
        }
        if (round > 0 &&
            before - complex_.total() < kSlow * std::abs(before - (complex_.total() - complex_.gain())) + kNothing)
            break;
    }
}

bool Repair::random_operator(int t, double slack) {
    const Tet tet = complex_.tet(t);
    const int e = random_.below(6);
    const int a = tet[kEdges[e][0]];
    const int b = tet[kEdges[e][1]];
    switch (random_.below(8)) {
    case 0:
    case 1:
        return operators_.remove_edge(a, b, slack);
    case 2:
        return operators_.flip_23(t, random_.below(4), slack);
    case 3:
    case 4:
        return random_.coin() ? operators_.collapse(a, b, slack) : operators_.collapse(b, a, slack);
    case 5:
    case 6:
        return operators_.split(a, b, slack).has_value();
    default:
        return random_.coin() ? insert_on_facet(t, slack).has_value() : insert_inside(t, false, slack);
    }
}

bool Repair::insert_inside(int t, bool anywhere, double slack) {
    const Tet tet = complex_.tet(t);
    double w[4] = {1, 1, 1, 1};
    double sum = 4.0;
    if (anywhere) {
        sum = 0.0;
        for (double &x : w)
            sum += x = kMiddle + random_.uniform();
    }
    Vec3 x;
    for (int i = 0; i < 4; ++i)
        x += (w[i] / sum) * complex_.point(tet[i]);
    return operators_.insert(t, x, slack).has_value();
}

std::optional<int> Repair::insert_on_facet(int t, double slack) {
    const Tet tet = complex_.tet(t);
    std::optional<Facet> chosen;
    int seen = 0;
    for (const auto &[p, q, r] : kFacets)
        if (complex_.is_surface(tet[p], tet[q], tet[r]) && random_.below(++seen) == 0)
            chosen = Facet{tet[p], tet[q], tet[r]};
    if (!chosen)
        return std::nullopt;
    const Facet key = sorted(*chosen);
    if (const auto peak = operators_.farthest(key))
        return operators_.refine(key, *peak, slack);
    Vec3 x;
    double sum = 0.0;
    for (int v : *chosen) {
        const double weight = kMiddle + random_.uniform();
        x += weight * complex_.point(v);
        sum += weight;
    }
    return operators_.insert_on_surface(*chosen, (1.0 / sum) * x, slack);
}

std::optional<int> Repair::snap(int t) {
    const Tet tet = complex_.tet(t);
    for (const auto &[p, q, r] : kFacets) {
        const Facet key = sorted(tet[p], tet[q], tet[r]);
        if (!complex_.is_surface(tet[p], tet[q], tet[r]) || complex_.over(key) <= 0.0)
            continue;
        const auto peak = operators_.farthest(key);
        if (!peak)
            continue;
        int best = -1;
        for (int v : key)
            if (complex_.vertex(v).stratum == Stratum::patch &&
                (best < 0 || norm(complex_.point(v) - *peak) < norm(complex_.point(best) - *peak)))
                best = v;
        if (best >= 0 && descent_.nudge(best, *peak)) {
            operators_.touch(best);
            return best;
        }
    }
    return std::nullopt;
}

bool Repair::chain(int t) {
    constexpr double slack = 5.0; // by which an operator of a chain may raise the energy
    constexpr double most = 20.0; // by which all of them together may
    bool any = false;
    const int length = 1 + random_.below(3);
    for (int k = 0; k < length; ++k) {
        int at = t;
        if (k > 0 || !complex_.alive(t)) {
            if (operators_.touched.empty())
                break;
            const int v = operators_.touched[random_.below(static_cast<int>(operators_.touched.size()))];
            if (!complex_.used(v))
                break;
            at = -1; // a bad tet of the star if there is one
            int seen = 0;
            for (int s : complex_.star(v))
                if (complex_.energy(s) > 0.0 && random_.below(++seen) == 0)
                    at = s;
            if (at < 0)
                at = complex_.star(v)[random_.below(static_cast<int>(complex_.star(v).size()))];
        }
        any |= random_operator(at, slack);
    }
    return any && complex_.gain() < most;
}

bool Repair::attempt(unsigned kind, int variant, int t, double slack) {
    const Tet tet = complex_.tet(t);
    switch (kind) {
    case edges:
        return operators_.remove_edge(tet[kEdges[variant][0]], tet[kEdges[variant][1]], slack);
    case facets:
        return operators_.flip_23(t, variant, slack);
    case collapses: {
        const int *e = kEdges[variant / 2];
        return variant % 2 ? operators_.collapse(tet[e[0]], tet[e[1]], 2 * slack)
                           : operators_.collapse(tet[e[1]], tet[e[0]], 2 * slack);
    }
    case splits: {
        const int *e = kEdges[random_.below(6)];
        return operators_.split(tet[e[0]], tet[e[1]], 2 * slack).has_value();
    }
    case inserts:
        return variant < 2 ? insert_inside(t, variant > 0, 2 * slack) : insert_on_facet(t, 2 * slack).has_value();
    case nudges: {
        bool any = false;
        for (int v : tet) {
            if (!descent_.nudge(v, complex_.point(v) + (kNudge * complex_.vertex(v).size) * random_.normal3()))
                continue;
            operators_.touch(v);
            any = true;
        }
        return any;
    }
    case groups:
        for (int v : tet)
            operators_.touch(v);
        return group_.relax_round(t);
    default:
        return chain(t);
    }
}

bool Repair::improve(const Recipe &recipe, int t) {
    // How often each may be tried, those first that mend most tets for what they cost; in any order within a row. More
    // of what is random mends less for its cost than the next kick.
    using Tries = std::pair<unsigned, int>;
    static constexpr std::array<Tries, 4> rows[] = {{{{edges, 6}, {facets, 4}, {collapses, 12}}},
                                                    {{{groups, 1}}},
                                                    {{{inserts, 4}, {nudges, 1}, {splits, 3}, {chains, 6}}}};
    tries_.clear();
    for (const auto &row : rows) {
        row_.clear();
        for (const auto &[kind, count] : row)
            for (int k = 0; k < count && (recipe.operators & kind); ++k)
                row_.push_back({kind, k});
        random_.shuffle(row_);
        tries_.insert(tries_.end(), row_.begin(), row_.end());
    }
    bool any = false;
    for (const auto &[kind, variant] : tries_) {
        if (!complex_.alive(t) || !energy_.bad(complex_.energy(t)))
            break;
        complex_.mark();
        operators_.touched.clear();
        if (attempt(kind, variant, t, recipe.slack)) {
            relax_touched(recipe);
            if (complex_.gain() < -kAny) {
                complex_.commit();
                any = true;
                continue;
            }
        }
        complex_.rollback();
    }
    return any;
}

void Repair::pass(const Recipe &recipe, const std::vector<int> &tets) {
    order_.clear();
    for (int t : tets)
        if (complex_.alive(t) && energy_.bad(complex_.energy(t)))
            order_.push_back(t);
    complex_.sort_worst_first(order_);
    for (int t : order_)
        if (complex_.alive(t) && energy_.bad(complex_.energy(t)))
            improve(recipe, t);
}

} // namespace wct::search
