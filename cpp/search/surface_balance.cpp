#include "search/surface_balance.h"

#include "base/sort_unique.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace wct::search {

namespace {
constexpr int kSweeps = 10;
constexpr int kSmooth = 4;         // sweeps
constexpr double kBalanced = 0.01; // of the tolerance

double volume_of(const TetComplex &complex, const Tet &tet) {
    return six_volumes(complex.point(tet[0]), complex.point(tet[1]), complex.point(tet[2]), complex.point(tet[3])) /
           6.0;
}

/// How the area of a triangle changes with its apex: half the edge from a to b, turned in its plane towards the apex.
Vec3 triangle_gradient(const Vec3 &apex, const Vec3 &a, const Vec3 &b) {
    const Vec3 edge = b - a, n = cross(edge, apex - a);
    return 0.5 * cross(unit(n), edge);
}
} // namespace

void SurfaceBalance::run() {
    smooth();
    even_out();
    keep_areas(kKept);
    if (!volumes_.empty())
        keep_volumes();
    const std::vector<char> kept = kept_patches();
    for (std::size_t p = 0; p < kept.size(); ++p)
        if (kept[p] && !guide_.planar(static_cast<int>(p))) // there is a curved one inside
            return keep_measures(kept, false);
}

void SurfaceBalance::smooth() {
    std::vector<TetComplex::SurfaceAt> around;
    for (int sweep = 0; sweep < kSmooth; ++sweep) {
        std::vector<double> height(complex_.vertex_slots(), 0.0);
        std::vector<int> curved;
        for (std::size_t k = 0; k < complex_.vertex_slots(); ++k) {
            const int v = static_cast<int>(k);
            const Vertex &vertex = complex_.vertex(v);
            if (!complex_.used(v) || vertex.stratum != Stratum::patch || guide_.planar(vertex.label))
                continue;
            curved.push_back(v);
            height[v] = guide_.height(vertex.label, vertex.position, vertex.hint);
        }
        for (const int v : curved) {
            double sum = 0.0;
            int count = 0;
            complex_.surface_at(v, around);
            for (const auto &[key, facet] : around)
                for (const int w : key)
                    if (w != v && complex_.vertex(w).stratum == Stratum::patch) {
                        sum += height[w];
                        ++count;
                    }
            if (count != 0)
                shift(v, 0.5 * (sum / count - height[v]));
        }
    }
}

void SurfaceBalance::even_out() {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        std::vector<double> offset = offsets();
        if (std::all_of(offset.begin(), offset.end(),
                        [&](double here) { return std::abs(here) <= kBalanced * guide_.tolerance(); }))
            return;
        for (double &here : offset)
            here = -here;
        if (!shift_patches(offset))
            return;
    }
}

bool SurfaceBalance::shift_patches(const std::vector<double> &by) {
    bool any = false;
    for (std::size_t k = 0; k < complex_.vertex_slots(); ++k) {
        const int v = static_cast<int>(k);
        const Vertex &vertex = complex_.vertex(v);
        if (complex_.used(v) && vertex.stratum == Stratum::patch && !guide_.planar(vertex.label) &&
            by[vertex.label] != 0.0)
            any |= shift(v, by[vertex.label]);
    }
    return any;
}

Vec3 SurfaceBalance::area_gradient(int v, int patch) const {
    Vec3 sum;
    std::vector<TetComplex::SurfaceAt> around;
    complex_.surface_at(v, around);
    for (const auto &[key, facet] : around) {
        if (facet->patch != patch)
            continue;
        std::array<Vec3, 2> others;
        std::size_t count = 0;
        for (const int w : key)
            if (w != v)
                others[count++] = complex_.point(w);
        sum += triangle_gradient(complex_.point(v), others[0], others[1]);
    }
    return sum;
}

std::vector<std::vector<int>> SurfaceBalance::curved_rims() const {
    std::vector<std::vector<int>> rims(guide_.patches());
    std::vector<TetComplex::SurfaceAt> around;
    for (std::size_t k = 0; k < complex_.vertex_slots(); ++k) {
        const int v = static_cast<int>(k);
        const Vertex &vertex = complex_.vertex(v);
        if (!complex_.used(v) || vertex.stratum != Stratum::crease || guide_.straight(vertex.label))
            continue;
        complex_.surface_at(v, around);
        for (const auto &[key, facet] : around)
            if (guide_.planar(facet->patch) && (rims[facet->patch].empty() || rims[facet->patch].back() != v))
                rims[facet->patch].push_back(v);
    }
    return rims;
}

std::vector<double> SurfaceBalance::missing_areas() const {
    std::vector<double> missing(guide_.patches(), 0.0);
    for (std::size_t patch = 0; patch < missing.size(); ++patch)
        missing[patch] = guide_.area(static_cast<int>(patch));
    for (const auto &[key, patch] : complex_.sorted_surface())
        missing[patch] -= 0.5 * norm(normal_of(complex_.corners(key)));
    return missing;
}

std::vector<double> SurfaceBalance::missing_volumes() const {
    std::vector<double> missing(volumes_.begin(), volumes_.end());
    for (std::size_t k = 0; k < complex_.tet_slots() && !volumes_.empty(); ++k)
        if (const int t = static_cast<int>(k); complex_.alive(t))
            missing[complex_.region(t)] -= volume_of(complex_, complex_.tet(t));
    return missing;
}

void SurfaceBalance::keep_areas(double share) {
    const std::vector<std::vector<int>> rims = curved_rims();
    if (std::all_of(rims.begin(), rims.end(), [](const std::vector<int> &rim) { return rim.empty(); }))
        return;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        const std::vector<double> missing = missing_areas();
        bool any = false;
        for (std::size_t p = 0; p < rims.size(); ++p) {
            const int patch = static_cast<int>(p);
            if (rims[p].empty() || std::abs(missing[p]) <= share * guide_.area(patch))
                continue;
            const bool much = std::abs(missing[p]) > kMuch * guide_.area(patch);
            double length = 0.0;
            for (const int v : rims[p])
                length += norm(area_gradient(v, patch));
            for (const int v : rims[p]) {
                const Vec3 to = complex_.point(v) + (missing[p] / length) * unit(area_gradient(v, patch));
                any |= much ? move_with_room(v, to) : move(v, to);
            }
        }
        if (!any)
            return;
    }
}

/// What is to be kept, the volume of a region or the area of a patch: how much is missing, and how it changes with the
/// vertices.
struct SurfaceBalance::Measure {
    double target = 0.0, missing = 0.0;
    std::map<int, Vec3> gradient{};
    double squares = 0.0; // of the gradient

    double share() const { return std::abs(missing) / target; }
};

std::vector<char> SurfaceBalance::kept_patches() const {
    std::vector<char> kept(guide_.patches(), 0);
    const std::vector<std::vector<int>> rims = curved_rims();
    for (std::size_t p = 0; p < kept.size(); ++p)
        kept[p] = !rims[p].empty();
    for (const auto &[key, patch] : complex_.sorted_surface())
        kept[patch] = kept[patch] || (!guide_.planar(patch) && complex_.has_both_sides(key));
    return kept;
}

std::vector<SurfaceBalance::Measure> SurfaceBalance::measures(const std::vector<char> &kept) const {
    std::vector<Measure> all;
    if (std::ranges::find(kept, 1) != kept.end()) { // else the facets need not be gone through
        const std::vector<double> areas = missing_areas();
        for (std::size_t p = 0; p < kept.size(); ++p)
            if (kept[p])
                all.push_back({guide_.area(static_cast<int>(p)), areas[p]});
    }
    const std::vector<double> volumes = missing_volumes(); // last: where not all can be had, these are met
    for (std::size_t r = 0; r < volumes.size(); ++r)
        all.push_back({volumes_[r], volumes[r]});
    return all;
}

void SurfaceBalance::add_gradients(const std::vector<char> &kept, std::vector<Measure> &all) const {
    std::vector<int> number(kept.size(), -1);
    int first = 0;
    for (std::size_t p = 0; p < kept.size(); ++p)
        if (kept[p])
            number[p] = first++;
    for (const auto &[key, patch] : complex_.sorted_surface()) {
        const std::array<Vec3, 3> corners = complex_.corners(key);
        const Vec3 normal = normal_of(corners);
        for (const int t : complex_.star(key[0])) {
            if (volumes_.empty() || !complex_.has(t, key[1]) || !complex_.has(t, key[2]))
                continue;
            const double out = dot(complex_.centroid(t) - corners[0], normal) < 0.0 ? 1.0 : -1.0;
            for (const int v : key)
                all[first + complex_.region(t)].gradient[v] += (out / 6.0) * normal;
        }
        for (std::size_t i = 0; i < 3 && number[patch] >= 0; ++i)
            all[number[patch]].gradient[key[i]] +=
                triangle_gradient(corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]);
    }
    for (Measure &one : all)
        for (auto &[v, gradient] : one.gradient) {
            const Vertex &vertex = complex_.vertex(v);
            Vec3 x = vertex.position;
            gradient = guide_.moves(vertex) ? guide_.admit(vertex, x).of(gradient) : Vec3{};
            one.squares += dot(gradient, gradient);
        }
}

/// Small steps that give each what it misses beyond what is borne, found one after the other, again and again
/// (Kaczmarz).
std::map<int, Vec3> SurfaceBalance::steps_for(const std::vector<Measure> &measures) {
    constexpr int rounds = 30;
    std::map<int, Vec3> steps;
    for (int round = 0; round < rounds; ++round)
        for (const Measure &one : measures) {
            double left = one.missing;
            for (const auto &[v, gradient] : one.gradient)
                left -= dot(gradient, steps[v]);
            const double borne = kAimed * one.target;
            if (std::abs(left) <= borne || one.squares == 0.0)
                continue;
            left -= std::copysign(borne, left);
            for (const auto &[v, gradient] : one.gradient)
                steps[v] += (left / one.squares) * gradient;
        }
    return steps;
}

double SurfaceBalance::missed(const std::vector<char> &kept) const {
    double sum = 0.0;
    for (const Measure &one : measures(kept))
        sum += std::max(0.0, one.share() - kBorne);
    return sum;
}

void SurfaceBalance::keep_measures(const std::vector<char> &kept, bool forced) {
    const double most = 0.5 * guide_.tolerance(); // of a step
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        std::vector<Measure> all = measures(kept);
        if (std::ranges::all_of(all, [](const Measure &one) { return one.share() <= kBorne; }))
            return;
        add_gradients(kept, all);
        std::set<int> much; // vertices of what misses so much that the mesh beside is to make room
        for (const Measure &one : all)
            if (one.share() > kMuch)
                for (const auto &[v, gradient] : one.gradient)
                    much.insert(v);
        bool any = false;
        for (const auto &[v, step] : steps_for(all)) {
            const double length = norm(step);
            if (length == 0.0)
                continue;
            const Vec3 to = complex_.point(v) + std::min(1.0, most / length) * step;
            any |= forced ? descent_.nudge(v, to) : much.contains(v) ? move_with_room(v, to) : move(v, to);
        }
        if (!any)
            return;
    }
}

void SurfaceBalance::keep_volumes() {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
        const std::vector<double> missing = missing_volumes();
        bool kept = true;
        for (std::size_t r = 0; r < missing.size(); ++r)
            kept = kept && std::abs(missing[r]) <= kKept * volumes_[r];
        if (kept)
            return;
        // By how much each region grows when a curved patch is shifted by 1.
        std::vector<std::vector<double>> growth(missing.size(), std::vector<double>(guide_.patches(), 0.0));
        for (const auto &[key, patch] : complex_.sorted_surface()) {
            if (guide_.planar(patch))
                continue;
            const std::array<Vec3, 3> corners = complex_.corners(key);
            const Vec3 middle = (1.0 / 3.0) * (corners[0] + corners[1] + corners[2]);
            const Vec3 normal = guide_.normal(patch, middle, complex_.facet(key).hints[0]);
            for (const int t : complex_.star(key[0])) {
                if (!complex_.has(t, key[1]) || !complex_.has(t, key[2]))
                    continue;
                const double side = dot(complex_.centroid(t) - middle, normal) < 0.0 ? 1.0 : -1.0;
                growth[complex_.region(t)][patch] += side * 0.5 * norm(normal_of(corners));
            }
        }
        // Shifts that give each region what it misses (Kaczmarz): equal ones on all its patches, region by region.
        constexpr int rounds = 8;
        std::vector<double> by(guide_.patches(), 0.0);
        for (int round = 0; round < rounds; ++round)
            for (std::size_t r = 0; r < missing.size(); ++r) {
                double left = missing[r], area = 0.0;
                for (std::size_t p = 0; p < by.size(); ++p) {
                    left -= growth[r][p] * by[p];
                    area += std::abs(growth[r][p]);
                }
                for (std::size_t p = 0; p < by.size() && area > 0.0; ++p)
                    if (growth[r][p] != 0.0)
                        by[p] += std::copysign(left / area, left * growth[r][p]);
            }
        if (!shift_patches(by))
            return;
    }
}

std::vector<double> SurfaceBalance::offsets() {
    std::vector<double> sum(guide_.patches(), 0.0), area(guide_.patches(), 0.0);
    for (const auto &[key, patch] : complex_.sorted_surface()) { // in order, or the sums would depend on it
        if (guide_.planar(patch))
            continue;
        const std::array<Vec3, 3> corners = complex_.corners(key);
        const double here = norm(normal_of(corners));
        sum[patch] += here * guide_.offset(patch, corners, complex_.facet(key).hints);
        area[patch] += here;
    }
    for (std::size_t patch = 0; patch < sum.size(); ++patch)
        sum[patch] = area[patch] > 0.0 ? sum[patch] / area[patch] : 0.0;
    return sum;
}

SurfaceBalance::Short SurfaceBalance::count_short(std::span<const int> tets) const {
    Short found;
    for (const int t : tets) {
        found.of_margin += energy_.bad(complex_.energy(t));
        found.of_goal += energy_.misses_goal(complex_.energy(t));
    }
    return found;
}

std::vector<int> SurfaceBalance::tets_near(int v) const {
    std::vector<int> tets;
    for (const int t : complex_.star(v))
        for (const int w : complex_.tet(t))
            tets.insert(tets.end(), complex_.star(w).begin(), complex_.star(w).end());
    sort_unique(tets);
    return tets;
}

bool SurfaceBalance::shift(int v, double by) {
    const Vertex &vertex = complex_.vertex(v);
    return move(v, vertex.position + by * guide_.normal(vertex.label, vertex.position, vertex.hint));
}

bool SurfaceBalance::move(int v, const Vec3 &x) {
    const Short before = count_short(complex_.star(v));
    complex_.mark();
    if (descent_.nudge(v, x) && !before.fewer_than(count_short(complex_.star(v)))) {
        complex_.commit();
        return true;
    }
    complex_.rollback();
    return false;
}

bool SurfaceBalance::move_with_room(int v, const Vec3 &x) {
    constexpr int rounds = 3;
    const std::vector<int> tets = tets_near(v); // no other's shape changes
    const Short before = count_short(tets);
    complex_.mark();
    bool stays = !descent_.nudge(v, x);
    for (int round = 0; !stays && before.fewer_than(count_short(tets)); ++round)
        stays = round == rounds || !relax_beside(v);
    if (stays)
        complex_.rollback();
    else
        complex_.commit();
    return !stays;
}

bool SurfaceBalance::relax_beside(int v) {
    constexpr int steps = 6;
    std::vector<int> beside;
    for (const int t : complex_.star(v))
        for (const int w : complex_.tet(t))
            if (w != v && complex_.vertex(w).stratum != Stratum::crease)
                beside.push_back(w);
    sort_unique(beside);
    bool any = false;
    for (const int w : beside)
        any |= descent_.relax(w, steps);
    return any;
}

} // namespace wct::search
