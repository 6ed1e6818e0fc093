#include "search/local_search.h"

#include "search/surface_balance.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

namespace wct::search {

namespace {
/// The two forms the search alternates between: a broad one that pulls, and one close to counting. Margins and powers
/// are those of EnergyForm; the count is what a tet costs that misses the goal, beside at most 1 for a quarter turn.
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
    constexpr double wider3 = 1.5, wider2 = 1.25; // where penalties begin, in margins: they are flat at their ends
    SearchForm form = sharp_form(acute, wider3 * margin, wider2 * margin);
    form.clearance = margin;
    form.hard_count = 1.0;
    return form;
}

/// Whether there are interfaces or sheets.
bool has_inner_facets(const TetComplex &complex) {
    const auto facets = complex.sorted_surface();
    return std::ranges::any_of(facets, [&](const auto &facet) { return complex.has_both_sides(facet.first); });
}
} // namespace

LocalSearch::LocalSearch(TetComplex &complex, const SurfaceGuide &guide, const SearchOptions &options)
    : complex_(complex), guide_(guide), options_(options), random_(options.seed),
      // Bodies without inner facets come right either way; a cube takes a fifth longer with divided corners.
      bench_(complex, guide, broad_form(options.acute), options_, options.acute && has_inner_facets(complex)),
      crew_(bench_, guide, options_), sweeps_(crew_, random_), kicks_(crew_, random_) {
    WCT_CHECK(complex_.checks.start(complex_);)
}

void LocalSearch::adopt(const SearchForm &form) {
    bench_.energy.adopt(form);
    std::vector<int> slots;
    std::vector<Tet> tets;
    for (std::size_t k = 0; k < complex_.tet_slots(); ++k)
        if (const int t = static_cast<int>(k); complex_.alive(t)) {
            slots.push_back(t);
            tets.push_back(complex_.tet(t));
        }
    std::vector<double> energies(tets.size());
    bench_.energy.of_present(complex_, tets, energies.data());
    for (std::size_t k = 0; k < slots.size(); ++k)
        complex_.set_energy(slots[k], energies[k]);
    complex_.resum();
}

std::vector<int> LocalSearch::bad_tets() const {
    std::vector<int> bad;
    for (std::size_t k = 0; k < complex_.tet_slots(); ++k)
        if (const int t = static_cast<int>(k); complex_.alive(t) && bench_.energy.bad(complex_.energy(t)))
            bad.push_back(t);
    return bad;
}

void LocalSearch::sweep(int recipe) {
    std::vector<int> tets = bad_tets();
    if (recipe != 0)
        std::erase_if(tets, [&](int t) { return complex_.ruled_out(t); });
    sweeps_.run(recipe, std::move(tets));
}

void LocalSearch::widen_margins(const SearchProgress &progress) {
    constexpr long part = 8; // of the kicks borne for tets that miss the goal itself
    const auto bearable = [this](int bad) { return patience(bad) / part; };
    const int before = count_bad(); // on facets that rule the goal out
    const TetComplex saved = complex_;
    adopt(margin_form(options_.acute, options_.margin));
    if (!kicks_.allowed) // which a sweep does not ask
        sweep(1);
    kick_until_good(progress, "margin", bearable);
    // Several margins may have been bought with a tet that misses the goal.
    adopt(sharp_form(options_.acute));
    if (!outcome_.stopped)
        kick_until_good(progress, "margin", bearable);
    if (count_bad() > before)
        complex_ = saved;
    adopt(margin_form(options_.acute, options_.margin));
}

bool LocalSearch::kick_until_good(const SearchProgress &progress, const char *phase,
                                  const std::function<long(int)> &bearable) {
    constexpr long rest = 4096; // kicks between sums from scratch
    constexpr long hear = 8;    // kicks between reports
    kicks_.restart();
    const int beside = count_bad() - kicks_.bad(); // on facets that rule the goal out
    int least = kicks_.bad();
    std::optional<TetComplex> best; // the mesh with so few, once kicks may leave it worse
    long vain = 0;                  // kicks since there were fewer bad tets than ever before
    Price price;
    const auto give_up = [&] {
        if (best && kicks_.bad() > least)
            complex_ = *std::move(best);
        return false;
    };
    for (long done = 0; kicks_.bad() > 0; ++done) {
        const long limit = std::max(1L, bearable(least));
        if (vain >= limit || !worthwhile(price, least) || work() >= options_.work)
            return give_up();
        if (done % rest == 0)
            crew_.resum();
        outcome_.bad = beside + least;
        if (done % hear == 0 &&
            !progress(phase, static_cast<double>(vain) / static_cast<double>(limit), outcome_.bad)) {
            outcome_.stopped = true;
            return give_up();
        }
        if (!best && kicks_.tried())
            best = complex_;
        ++outcome_.kicks;
        const Kicks::Outcome kick = kicks_.once();
        outcome_.accepted += kick.better;
        ++vain;
        price.add(static_cast<double>(kick.evaluations), std::max(0, least - kicks_.bad()));
        if (kicks_.bad() < least) {
            least = kicks_.bad();
            best.reset();
            vain = 0;
        }
    }
    return true;
}

void LocalSearch::Price::add(double evaluations, int fewer) {
    constexpr double keep = 1.0 - 1.0 / 48.0;
    spent += evaluations;
    work = keep * work + evaluations;
    gone = keep * gone + fewer;
}

bool LocalSearch::worthwhile(const Price &price, int bad) const {
    const double worth = options_.worth;
    constexpr double small = 3000.0; // tets: a mesh of less is worth as much
    return price.spent < worth * small || price.work * bad <= worth * static_cast<double>(complex_.tets()) * price.gone;
}

long LocalSearch::patience(int bad) const {
    // Few bad tets in many are worth long trying, and there will not be many such phases; where a good part of the mesh
    // is bad, as round a surface that may not change, most of it is hopeless.
    constexpr double many = 2000.0; // tets to a bad one, for which all the kicks asked for are borne
    constexpr double least = 0.005; // share of them
    const double share = (static_cast<double>(complex_.tets()) + many) / (many * std::max(bad, 1));
    return std::max(1L, static_cast<long>(static_cast<double>(options_.kicks) * std::clamp(share, least, 1.0)));
}

long LocalSearch::hurried(int bad) const {
    constexpr long most = 8, least = 50; // parts of the kicks asked for: the last few bad tets are worth more each
    return std::max(options_.kicks / least, options_.kicks / most / std::max(bad, 1));
}

void LocalSearch::keep_by_force(SurfaceBalance &balance, const SearchProgress &progress,
                                const std::function<long(int)> &bearable) {
    constexpr int most = 6; // attempts
    // What may still be missed when all tets are mended, of what was: more where that did not come to good.
    constexpr double half = 0.5, more = 0.25;
    const std::vector<char> patches = balance.kept_patches();
    double missed = balance.missed(patches), share = half;
    for (int attempt = 0; attempt < most && missed > 0.0 && share < 1.0 && !outcome_.stopped; ++attempt) {
        const TetComplex saved = complex_;
        adopt(sharp_form(options_.acute));
        balance.force(patches);
        const double bound = std::max(share * missed, balance.missed(patches));
        kicks_.allowed = [&](Workbench &bench) {
            const SurfaceBalance there(bench.complex, bench.energy, guide_, bench.descent, options_.volumes);
            return there.missed(patches) <= bound;
        };
        const bool good = bound < missed && kick_until_good(progress, "kicks", bearable);
        if (good)
            widen_margins(progress);
        kicks_.allowed = nullptr;
        const double now = balance.missed(patches);
        if (good && now < missed) {
            missed = now;
        } else {
            complex_ = saved;
            share += more;
        }
    }
}

SearchOutcome LocalSearch::run(const SearchProgress &progress) {
    const auto report = [&](const char *phase, double done) {
        outcome_.bad = count_bad();
        outcome_.stopped = !progress(phase, done, outcome_.bad);
        return !outcome_.stopped;
    };
    bench_.watch.begin();
    constexpr int cycle = 3;      // passes, one of each recipe
    constexpr double worth = 0.9; // what a cycle must bring the bad tets down to for another to begin
    double before = std::numeric_limits<double>::infinity();
    for (int k = 0; k < options_.passes; ++k) {
        adopt(k % cycle == 0 ? broad_form(options_.acute) : sharp_form(options_.acute));
        if (!report("passes", static_cast<double>(k) / options_.passes) || outcome_.bad == 0 || work() >= options_.work)
            break;
        if (k % cycle == 0) {
            if (outcome_.bad > worth * before)
                break;
            before = outcome_.bad;
        }
        sweep(k % cycle);
        ++outcome_.passes;
    }
    adopt(sharp_form(options_.acute));
    const auto bearable = [this](int bad) { return options_.hurry ? hurried(bad) : patience(bad); };
    const bool good = !outcome_.stopped && kick_until_good(progress, "kicks", bearable) && report("kicks", 1.0);
    SurfaceBalance balance(complex_, bench_.energy, guide_, bench_.descent, options_.volumes);
    if (good) {
        balance.keep_areas_roughly();
        widen_margins(progress);
    }
    if (good || outcome_.stopped || !options_.hurry) // else more is to come
        balance.run();
    if (good && !options_.volumes.empty())
        keep_by_force(balance, progress, bearable);
    adopt(sharp_form(options_.acute));
    outcome_.stuck = bad_tets();
    outcome_.bad = static_cast<int>(outcome_.stuck.size());
    std::erase_if(outcome_.stuck, [&](int t) { return complex_.ruled_out(t); });
    outcome_.evaluations = crew_.spent().evaluations;
    outcome_.work = work();
    WCT_CHECK(complex_.checks.end(complex_, guide_);)
    return outcome_;
}

} // namespace wct::search
