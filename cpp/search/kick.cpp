#include "search/kick.h"

#include "base/sort_unique.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wct::search {

namespace {
constexpr double kLoose = 3.0; // how far beyond the tolerance a kick may go, in tolerances
/// Shares of the kicks that refine the surface, at a facet beyond the tolerance, the same where that has failed often
/// enough, and at others. A tet only short of a margin must first have withstood all else: small curved meshes would
/// pay for it with tets.
constexpr double kRefineOver = 0.9;
constexpr double kRefineStuck = 0.4;
constexpr double kRefine = 0.25;
} // namespace

void Kick::ball(const Vec3 &center, double radius, int vertex, std::vector<int> &out) {
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

void Kick::open_wedges(int t) {
    constexpr double acute = 0.02; // cosine below which a facet between two creases counts as not acute
    const Tet tet = complex_.tet(t);
    for (int c : tet) {
        if (complex_.vertex(c).stratum != Stratum::corner)
            continue;
        std::vector<Edge> opposite;
        for (int s : complex_.star(c))
            for (const auto &edge : kEdges) {
                const int a = complex_.tet(s)[edge[0]], b = complex_.tet(s)[edge[1]];
                if (a == c || b == c || !complex_.is_crease(a, c) || !complex_.is_crease(b, c))
                    continue;
                const Vec3 p = complex_.point(a) - complex_.point(c), q = complex_.point(b) - complex_.point(c);
                if (dot(p, q) < acute * norm(p) * norm(q))
                    opposite.push_back(sorted(a, b));
            }
        sort_unique(opposite);
        for (const auto &[a, b] : opposite)
            operators_.split(a, b, std::numeric_limits<double>::infinity());
    }
}

void Kick::mend_valence(int t) {
    constexpr std::size_t few = 4;
    constexpr double slack = std::numeric_limits<double>::infinity();
    const Tet tet = complex_.tet(t);
    for (int v : tet) {
        if (!complex_.used(v) || complex_.vertex(v).stratum != Stratum::patch)
            continue;
        complex_.surface_at(v, facets_);
        if (facets_.size() > few)
            continue;
        const Facet &facet = facets_[random_.below(static_cast<int>(facets_.size()))].key;
        int i = 0;
        while (facet[i] != v)
            ++i;
        const int a = facet[(i + 1) % 3], b = facet[(i + 2) % 3];
        watch_.loose = kLoose;
        random_.coin() ? operators_.collapse(v, random_.coin() ? a : b, slack) : operators_.remove_edge(a, b, slack);
        watch_.loose = 0.0;
    }
}

void Kick::refine_surface(int t) {
    constexpr int most = 6;       // a ridge needs a row of vertices at once
    constexpr double close = 0.3; // of the shortest edge elsewhere: what is too near can be collapsed afterwards
    constexpr double slack = std::numeric_limits<double>::infinity();
    const double shortest = operators_.shortest;
    const bool over = complex_.over(complex_.tet(t)) > 0.0;
    if (over)
        operators_.shortest *= close;
    watch_.loose = kLoose;
    std::optional<int> v;
    if (over && random_.coin())
        v = repair_.snap(t);
    if (!v)
        v = repair_.insert_on_facet(t, slack);
    for (int k = 1; v && k < most; ++k) {
        const auto facet = worst_facet(*v);
        const auto peak = facet ? operators_.farthest(*facet) : std::nullopt;
        v = peak ? operators_.refine(*facet, *peak, slack) : std::nullopt;
    }
    watch_.loose = 0.0;
    operators_.shortest = shortest;
}

std::optional<Facet> Kick::worst_facet(int v) {
    std::optional<Facet> worst;
    double most = 0.0;
    complex_.surface_at(v, facets_);
    for (const auto &[key, facet] : facets_)
        if (facet->over > most) {
            most = facet->over;
            worst = key;
        }
    return worst;
}

void Kick::shake(int t, const Strength &kick, double refine) {
    const Tet tet = complex_.tet(t);
    const Vec3 center = complex_.centroid(t);
    std::vector<int> vertices;
    ball(center, kick.radius * complex_.vertex(tet[0]).size, tet[0], vertices);
    operators_.touched = vertices;
    for (int v : tet)
        operators_.touch(v);
    vertices = operators_.touched;
    for (int v : vertices)
        if (random_.coin())
            descent_.nudge(v, complex_.point(v) + (kick.sigma * complex_.vertex(v).size) * random_.normal3());
    if (random_.coin())
        open_wedges(t);
    if (random_.coin())
        mend_valence(t);
    if (random_.uniform() < refine)
        refine_surface(t);
    for (int k = 0; k < kick.operators; ++k) {
        const int v = operators_.touched[random_.below(static_cast<int>(operators_.touched.size()))];
        if (complex_.used(v))
            repair_.random_operator(complex_.star(v)[random_.below(static_cast<int>(complex_.star(v).size()))],
                                    kick.slack);
    }
    for (int round = 0; round < 3; ++round) {
        vertices = operators_.touched;
        for (int v : vertices)
            descent_.relax(v, 3);
        repair_.flip_round(vertices);
    }
}

void Kick::near_changed(const Vec3 &center, double radius) {
    constexpr std::size_t most = 48; // where much falls short, all of it within the radius would be a sweep of its own
    complex_.changed(changed_);
    nearest_.clear();
    for (int t : changed_) {
        if (!complex_.alive(t) || complex_.energy(t) <= 0.0 || complex_.ruled_out(t))
            continue;
        const double distance = norm(complex_.point(complex_.tet(t)[0]) - center);
        if (distance <= radius)
            nearest_.push_back({distance, t});
    }
    std::sort(nearest_.begin(), nearest_.end());
    nearest_.resize(std::min(nearest_.size(), most));
    changed_.clear();
    for (const auto &[distance, t] : nearest_)
        changed_.push_back(t);
}

bool Kick::repair(const Vec3 &center, double radius, double worse) {
    double previous = std::numeric_limits<double>::infinity();
    constexpr int rounds = 4;
    // Energies: from which on a kick will hardly come to good, after one round and two; and what is no gain.
    constexpr double hopeless = 1.5, far = 0.3, little = 1e-3;
    for (int round = 0; round < rounds; ++round) {
        near_changed(center, radius);
        repair_.pass(Repair::recipes[std::min(round, 2)], changed_);
        const double gain = complex_.gain();
        if ((round >= 1 && gain > hopeless) || (round >= 2 && gain > far))
            return false;
        if (round > 1 && gain > previous - little)
            break;
        previous = gain;
    }
    return complex_.gain() < worse;
}

bool Kick::at(int t, int failures) {
    static constexpr Strength strengths[] = {
        {1.0, 0.12, 2, 4.0}, {1.4, 0.2, 4, 6.0}, {0.9, 0.3, 4, 10.0}, {0.7, 0.3, 2, 10.0}};
    constexpr int few = 10;        // failures
    constexpr double equal = 0.02; // energies
    constexpr double most = 1.2;   // by which it may get worse: a bad tet more counts .3
    const Strength &kick = strengths[random_.below(std::size(strengths))];
    const Tet tet = complex_.tet(t);
    const Vec3 center = complex_.centroid(t);
    constexpr double reach = 3.5; // of what is repaired round a kick, in sizes
    const double radius = reach * complex_.vertex(tet[0]).size;
    // Where nothing has helped, the mesh may be too coarse: allow finer edges, and no coarser ones.
    constexpr double finer = 0.65;
    const bool stuck = failures >= few;
    const double shortest = operators_.shortest, longest = operators_.longest;
    if (stuck && random_.coin()) {
        operators_.shortest *= finer;
        operators_.longest *= finer;
    }
    double refine = stuck || energy_.misses_goal(complex_.energy(t)) ? kRefine : 0.0;
    if (complex_.over(tet) > 0.0)
        refine = stuck ? kRefineStuck : kRefineOver;
    const int over = complex_.over_count();
    shake(t, kick, refine);
    const double chance = random_.uniform();
    const double worse = equal + (failures < tried ? 0.0 : most * chance * std::sqrt(chance));
    const bool keep = repair(center, radius, worse) && complex_.over_count() <= over;
    operators_.shortest = shortest;
    operators_.longest = longest;
    return keep;
}

} // namespace wct::search
