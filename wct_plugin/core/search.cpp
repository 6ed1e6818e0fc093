#include "search.h"

#include "surface_balance.h"

#include <algorithm>
#include <limits>

namespace wct {

namespace {
constexpr double kAny = 1e-7; // an energy drop worth keeping

/// The two forms the search alternates between: a broad one that pulls, and one close to counting.
SearchForm broad_form(bool acute) {
    SearchForm form;
    form.shape = {.margin3 = 0.06,
                  .power3 = 1.5,
                  .margin2 = 0.04,
                  .power2 = 2.0,
                  .weight2 = acute ? 0.5 : 0.0,
                  .weight_quality = 0.0};
    form.count = 0.05;
    return form;
}

SearchForm sharp_form(bool acute, double margin3 = 0.03, double margin2 = 0.02) {
    SearchForm form;
    form.shape = {.margin3 = margin3,
                  .power3 = 1.0,
                  .margin2 = margin2,
                  .power2 = 2.0,
                  .weight2 = acute ? 0.5 : 0.0,
                  .weight_quality = 0.0};
    form.count = 0.3;
    return form;
}
/// Counts the tets that meet the goal without the margin asked for; those that miss the goal weigh more.
SearchForm margin_form(bool acute, double margin) {
    SearchForm form = sharp_form(acute, 1.5 * margin, 1.25 * margin);
    form.clearance = margin;
    form.hard_count = 1.0;
    return form;
}
} // namespace

Search::Search(TetComplex &complex, const SurfaceGuide &guide, const SearchOptions &options)
    : complex_(complex), guide_(guide), options_(options), energy_(broad_form(options.acute)), watch_(complex, guide),
      operators_(complex, energy_, guide, watch_), descent_(complex, energy_, guide, watch_), random_(options.seed) {
    operators_.flip_surface = options.flip_surface;
    operators_.split_surface = options.split_surface;
}

void Search::adopt(const SearchForm &form) {
    energy_.adopt(form);
    for (std::size_t t = 0; t < complex_.tet_slots(); ++t)
        if (complex_.alive(static_cast<int>(t)))
            complex_.set_energy(static_cast<int>(t), energy_.of_present(complex_, complex_.tet(static_cast<int>(t))));
    complex_.resum();
}

int Search::count_bad() const {
    int bad = 0;
    for (std::size_t t = 0; t < complex_.tet_slots(); ++t)
        bad += complex_.alive(static_cast<int>(t)) && energy_.bad(complex_.energy(static_cast<int>(t)));
    return bad;
}

void Search::collect_bad(std::vector<int> &out) const {
    out.clear();
    for (std::size_t t = 0; t < complex_.tet_slots(); ++t)
        if (complex_.alive(static_cast<int>(t)) && energy_.bad(complex_.energy(static_cast<int>(t))))
            out.push_back(static_cast<int>(t));
}

void Search::flip_round(const std::vector<int> &vertices) {
    std::vector<int> tets;
    for (int v : vertices)
        for (int t : complex_.star(v))
            if (complex_.energy(t) > 0.0)
                tets.push_back(t);
    std::sort(tets.begin(), tets.end());
    tets.erase(std::unique(tets.begin(), tets.end()), tets.end());
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

void Search::relax_touched(const Recipe &recipe) {
    std::vector<int> vertices = operators_.touched;
    const double after_operator = complex_.gain();
    for (int round = 0; round < recipe.rounds; ++round) {
        const double before = complex_.total();
        for (int v : vertices)
            descent_.relax(v, recipe.steps);
        if (round == 0 && complex_.gain() > std::max(0.05, 0.7 * after_operator))
            return; // hopeless: the first round brings most of what there is to gain
        if (round < recipe.flips) {
            operators_.touched = vertices;
            flip_round(vertices);
            vertices = operators_.touched;
        }
        if (round > 0 &&
            before - complex_.total() < 1e-4 * std::abs(before - (complex_.total() - complex_.gain())) + 1e-10)
            break;
    }
}

bool Search::random_operator(int t, double slack) {
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
    default: {
        const Vec3 middle =
            0.25 * (complex_.point(tet[0]) + complex_.point(tet[1]) + complex_.point(tet[2]) + complex_.point(tet[3]));
        return operators_.insert(t, middle, slack).has_value();
    }
    }
}

bool Search::chain(int t) {
    constexpr double slack = 5.0;
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
    return any && complex_.gain() < 20.0;
}

bool Search::attempt(unsigned kind, int variant, int t, double slack) {
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
    case splits:
        return operators_.split(tet[kEdges[variant][0]], tet[kEdges[variant][1]], 2 * slack).has_value();
    case inserts: {
        double w[4] = {1, 1, 1, 1};
        double sum = 4.0;
        if (variant > 0) {
            sum = 0.0;
            for (double &x : w)
                sum += x = 0.3 + random_.uniform();
        }
        Vec3 x;
        for (int i = 0; i < 4; ++i)
            x += (w[i] / sum) * complex_.point(tet[i]);
        return operators_.insert(t, x, 2 * slack).has_value();
    }
    case nudges: {
        bool any = false;
        for (int v : tet) {
            if (!descent_.nudge(v, complex_.point(v) + (0.15 * complex_.vertex(v).size) * random_.normal3()))
                continue;
            operators_.touch(v);
            any = true;
        }
        return any;
    }
    default:
        return chain(t);
    }
}

int Search::pass(const Recipe &recipe, std::vector<std::pair<double, int>> &order) {
    static constexpr std::pair<unsigned, int> variants[] = {{edges, 6},   {facets, 4}, {collapses, 12}, {splits, 6},
                                                            {inserts, 2}, {nudges, 2}, {chains, 12}};
    std::sort(order.begin(), order.end()); // worst first, ties by number
    std::vector<std::pair<unsigned, int>> tries;
    int kept = 0;
    for (const auto &[minus_energy, t] : order) {
        if (!complex_.alive(t) || complex_.energy(t) <= 0.0)
            continue;
        tries.clear();
        for (const auto &[kind, count] : variants)
            for (int k = 0; k < count && (recipe.operators & kind); ++k)
                tries.push_back({kind, k});
        random_.shuffle(tries);
        for (const auto &[kind, variant] : tries) {
            if (!complex_.alive(t) || complex_.energy(t) <= 0.0)
                break;
            complex_.mark();
            operators_.touched.clear();
            if (!attempt(kind, variant, t, recipe.slack)) {
                complex_.rollback();
                continue;
            }
            relax_touched(recipe);
            if (complex_.gain() < -kAny) {
                complex_.commit();
                ++kept;
            } else {
                complex_.rollback();
            }
        }
    }
    return kept;
}

int Search::sweep(const Recipe &recipe) {
    order_.clear();
    for (std::size_t t = 0; t < complex_.tet_slots(); ++t)
        if (complex_.alive(static_cast<int>(t)) && complex_.energy(static_cast<int>(t)) > 0.0)
            order_.push_back({-complex_.energy(static_cast<int>(t)), static_cast<int>(t)});
    return pass(recipe, order_);
}

void Search::ball(const Vec3 &center, double radius, int vertex, std::vector<int> &out) {
    out.assign(1, vertex);
    marks_.resize(complex_.vertex_slots(), 0);
    marks_[vertex] = ++mark_;
    for (std::size_t k = 0; k < out.size(); ++k)
        for (int t : complex_.star(out[k]))
            for (int w : complex_.tet(t))
                if (marks_[w] != mark_) {
                    marks_[w] = mark_;
                    if (norm(complex_.point(w) - center) < radius)
                        out.push_back(w);
                }
}

int Search::sweep_near(const Recipe &recipe, const Vec3 &center, double radius, int vertex) {
    std::vector<int> vertices;
    ball(center, radius, vertex, vertices);
    order_.clear();
    for (int v : vertices)
        for (int t : complex_.star(v))
            if (complex_.energy(t) > 0.0)
                order_.push_back({-complex_.energy(t), t});
    std::sort(order_.begin(), order_.end());
    order_.erase(std::unique(order_.begin(), order_.end()), order_.end());
    return pass(recipe, order_);
}

void Search::kick(int t, const Kick &kick) {
    const Tet tet = complex_.tet(t);
    const Vec3 center =
        0.25 * (complex_.point(tet[0]) + complex_.point(tet[1]) + complex_.point(tet[2]) + complex_.point(tet[3]));
    std::vector<int> vertices;
    ball(center, kick.radius * complex_.vertex(tet[0]).size, tet[0], vertices);
    operators_.touched = vertices;
    for (int v : tet)
        operators_.touch(v);
    vertices = operators_.touched;
    for (int v : vertices)
        if (random_.coin())
            descent_.nudge(v, complex_.point(v) + (kick.sigma * complex_.vertex(v).size) * random_.normal3());
    for (int k = 0; k < kick.operators; ++k) {
        const int v = operators_.touched[random_.below(static_cast<int>(operators_.touched.size()))];
        if (complex_.used(v))
            random_operator(complex_.star(v)[random_.below(static_cast<int>(complex_.star(v).size()))], kick.slack);
    }
    for (int round = 0; round < 3; ++round) {
        vertices = operators_.touched;
        for (int v : vertices)
            descent_.relax(v, 3);
        flip_round(vertices);
    }
}

bool Search::try_kick(int t, bool few) {
    static constexpr Kick small[] = {{1.0, 0.12, 2, 4.0}, {1.4, 0.2, 4, 6.0}, {1.7, 0.3, 8, 8.0}, {0.9, 0.3, 4, 10.0}};
    static constexpr Kick large[] = {{2.2, 0.3, 16, 20.0}, {2.8, 0.25, 28, 20.0}, {1.6, 0.35, 14, 30.0}};
    static constexpr Recipe recipes[] = {{edges | facets | collapses, 1.0, 2, 4, 1},
                                         {edges | facets | collapses | splits | inserts | nudges, 1.0, 2, 4, 1},
                                         {127u, 2.0, 3, 4, 2}};
    // The last few sit in neighbourhoods the small kicks cannot leave.
    const bool wide = few && random_.below(10) < 4;
    const Tet tet = complex_.tet(t);
    const Vec3 center =
        0.25 * (complex_.point(tet[0]) + complex_.point(tet[1]) + complex_.point(tet[2]) + complex_.point(tet[3]));
    const double radius = (wide ? 3.1 : 2.3) * complex_.vertex(tet[0]).size;
    complex_.mark();
    kick(t, wide ? large[random_.below(3)] : small[random_.below(4)]);
    const std::vector<int> vertices = operators_.touched;
    double previous = std::numeric_limits<double>::infinity();
    bool promising = true;
    const int rounds = wide ? 7 : 4;
    for (int round = 0; round < rounds && promising; ++round) {
        int nearest = -1; // a living vertex to start the ball from
        double best = std::numeric_limits<double>::infinity();
        for (int v : vertices)
            if (complex_.used(v) && norm(complex_.point(v) - center) < best) {
                best = norm(complex_.point(v) - center);
                nearest = v;
            }
        if (nearest < 0)
            break;
        sweep_near(recipes[wide ? round % 3 : std::min(round, 2)], center, radius, nearest);
        const double gain = complex_.gain();
        if (wide) {
            promising = !((round >= 1 && gain > 6.0) || (round >= 3 && gain > 1.2));
            if (round > 4 && gain > previous - 1e-3)
                break;
        } else {
            promising = !((round > 0 && gain > 1.5) || (round == 2 && gain > 0.3));
            if (round > 1 && gain > previous - 1e-3)
                break;
        }
        previous = gain;
    }
    const bool keep = promising && complex_.gain() < 0.02;
    const bool better = keep && complex_.gain() < -1e-3;
    keep ? complex_.commit() : complex_.rollback();
    return better;
}

double Search::clearance() const {
    double worst = 1.0;
    for (std::size_t k = 0; k < complex_.tet_slots(); ++k) {
        const int t = static_cast<int>(k);
        if (!complex_.alive(t))
            continue;
        TetLanes lanes;
        for (int i = 0; i < 4; ++i)
            lanes.set_all(i, complex_.point(complex_.tet(t)[i]));
        WorstLanes found;
        measure_worst(lanes, options_.acute, found);
        worst = std::min({worst, found.height[0], found.cosine[0]});
    }
    return worst;
}

void Search::polish() {
    for (double margin : {0.02, 0.03, 0.05, 0.08}) {
        adopt(sharp_form(options_.acute, margin, margin));
        for (int sweep = 0; sweep < 6 && complex_.total() > 0.0; ++sweep) {
            complex_.mark();
            const double before = clearance();
            for (std::size_t v = 0; v < complex_.vertex_slots(); ++v)
                descent_.relax(static_cast<int>(v), 4);
            clearance() >= before ? complex_.commit() : complex_.rollback();
        }
    }
}

bool Search::kick_until_good(const SearchProgress &progress, const char *phase, long kicks) {
    std::vector<int> bad;
    for (long done = 0; done < kicks;) {
        if (done % 8 == 0 || bad.empty()) {
            collect_bad(bad);
            complex_.resum();
            outcome_.bad = static_cast<int>(bad.size());
            if (bad.empty())
                return true;
            if (!progress(phase, static_cast<double>(done) / static_cast<double>(kicks), outcome_.bad)) {
                outcome_.stopped = true;
                return false;
            }
        }
        const int k = random_.below(static_cast<int>(bad.size()));
        const int t = bad[k];
        if (!complex_.alive(t) || !energy_.bad(complex_.energy(t))) {
            bad[k] = bad.back();
            bad.pop_back();
            continue;
        }
        ++done;
        ++outcome_.kicks;
        outcome_.accepted += try_kick(t, bad.size() <= 12);
    }
    return false;
}

SearchOutcome Search::run(const SearchProgress &progress) {
    static constexpr Recipe recipes[] = {{edges | facets | collapses, 1.0, 2, 4, 1},
                                         {edges | facets | collapses | splits | inserts | nudges, 1.0, 2, 4, 1},
                                         {127u, 2.0, 3, 4, 2}};
    const auto report = [&](const char *phase, double done) {
        outcome_.bad = count_bad();
        outcome_.stopped = !progress(phase, done, outcome_.bad);
        return !outcome_.stopped;
    };
    watch_.begin();
    for (int k = 0; k < options_.passes; ++k) {
        adopt(k % 3 == 0 ? broad_form(options_.acute) : sharp_form(options_.acute));
        if (!report("passes", static_cast<double>(k) / options_.passes) || outcome_.bad == 0)
            break;
        sweep(recipes[k % 3]);
        ++outcome_.passes;
    }
    adopt(sharp_form(options_.acute));
    const bool good = !outcome_.stopped && kick_until_good(progress, "kicks", options_.kicks);
    if (good) {
        polish();
        adopt(margin_form(options_.acute, options_.margin));
        sweep(recipes[1]);
        kick_until_good(progress, "margin", options_.kicks);
    }
    SurfaceBalance(complex_, energy_, guide_, descent_).run();
    adopt(sharp_form(options_.acute));
    outcome_.bad = count_bad();
    outcome_.evaluations = energy_.evaluations();
    return outcome_;
}

} // namespace wct
