#include "sampling/sheets.h"

#include "base/sort_unique.h"
#include "sampling/curve_chains.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace wct::sampling {

namespace {

/// Whether a place so far from a sheet, between points an edge apart, is on it: in its plane, or over a curved one no
/// farther than a facet may sag.
bool is_on(const domain::Reference &reference, int patch, double distance, double edge) {
    constexpr double plane = 0.02, curved = 0.2; // edges
    return distance < (reference.planar(patch) ? plane : curved) * edge;
}

bool any_sheet(const domain::Reference &reference) {
    for (int patch = 0; patch < reference.patches(); ++patch)
        if (reference.sheet(patch))
            return true;
    return false;
}

/// The sheet that a facet is on, -1: none; `foot` receives where the facet's centroid belongs on it.
int sheet_of(const Cloud &cloud, const domain::Reference &reference, const Facet &facet, domain::Foot &foot) {
    for (const int patch : shared_patches(cloud, reference, facet)) {
        if (!reference.sheet(patch))
            continue;
        const Vec3 &a = cloud.points[facet[0]], &b = cloud.points[facet[1]], &c = cloud.points[facet[2]];
        const double edge = (norm(b - a) + norm(c - b) + norm(a - c)) / 3.0;
        foot = reference.nearest((1.0 / 3.0) * (a + b + c), patch, cloud.near[facet[0]]);
        if (is_on(reference, patch, foot.distance, edge))
            return patch;
    }
    return -1;
}

/// Height of a tet's centroid over the plane of a triangle of the reference.
double height(const Cloud &cloud, const domain::Reference &reference, const Tet &tet, const domain::Foot &foot) {
    return dot(cloud.centroid(tet) - foot.point, reference.normal(foot.triangle));
}

} // namespace

void find_sheets(const Cloud &cloud, const domain::Reference &reference, RestrictedDelaunay &complex,
                 const Workers &workers) {
    complex.sheets.clear();
    if (!any_sheet(reference))
        return;
    const auto &tets = complex.all.tets;
    complex.sheets.assign(tets.size(), 0);
    workers.for_each(tets.size(), 1024, [&](std::size_t k) {
        const int t = static_cast<int>(k);
        for (int i = 0; i < 4; ++i) {
            const auto facet = complex.facet(t, i);
            if (complex.region[t] < 0 || complex.beyond(t, i) != complex.region[t] ||
                std::any_of(facet.begin(), facet.end(), [&](int v) { return cloud.role[v] == Stratum::interior; }))
                continue;
            // From either side the same answer: the corners' order must not matter.
            Facet corners = facet;
            std::sort(corners.begin(), corners.end());
            domain::Foot foot;
            if (sheet_of(cloud, reference, corners, foot) < 0)
                continue;
            const double here = height(cloud, reference, tets[t], foot);
            const double there = height(cloud, reference, tets[complex.all.neighbours[t][i]], foot);
            if (here * there < 0.0) // of a sliver on a curved sheet not all facets
                complex.sheets[t] |= static_cast<std::uint8_t>(1 << i);
        }
    });
}

std::vector<int> torn_sheets(const Cloud &cloud, const domain::Reference &reference,
                             const RestrictedDelaunay &complex) {
    std::vector<int> torn;
    if (!any_sheet(reference))
        return torn;
    std::map<std::array<int, 3>, int> facets; // patch and edge -> how many
    for (int t = 0; t < static_cast<int>(complex.all.tets.size()); ++t)
        for (int i = 0; i < 4; ++i) {
            if (!complex.on_sheet(t, i) || t > complex.all.neighbours[t][i])
                continue;
            const Facet f = sorted(complex.facet(t, i));
            domain::Foot foot;
            const int patch = sheet_of(cloud, reference, f, foot);
            for (const auto &[v, w] : {std::array{f[0], f[1]}, std::array{f[1], f[2]}, std::array{f[0], f[2]}})
                ++facets[{patch, v, w}];
        }
    std::vector<char> seen(static_cast<std::size_t>(reference.patches()), 0);
    for (const auto &[edge, count] : facets)
        seen[edge[0]] = 1;
    const auto chains = curve_chains(cloud, reference);
    for (std::size_t c = 0; c < chains.size(); ++c)
        for (const int patch : reference.patches_at_curve(static_cast<int>(c)))
            for (std::size_t k = 0; reference.sheet(patch) && k + 1 < chains[c].size(); ++k) {
                const auto [v, w] = std::minmax(chains[c][k].point, chains[c][k + 1].point);
                const auto found = facets.find({patch, v, w});
                if (found == facets.end() || found->second > 2)
                    torn.insert(torn.end(), {v, w});
                else
                    facets.erase(found);
            }
    for (const auto &[edge, count] : facets)
        if (count != 2)
            torn.insert(torn.end(), {edge[1], edge[2]});
    for (std::size_t i = 0; i < cloud.count(); ++i) // a sheet without a facet
        if (cloud.role[i] == Stratum::patch && reference.sheet(cloud.label[i]) && !seen[cloud.label[i]])
            torn.push_back(static_cast<int>(i));
    return torn;
}

std::vector<int> piercing_points(const Cloud &cloud, const domain::Reference &reference,
                                 const RestrictedDelaunay &complex, const Workers &workers) {
    constexpr double close = 1.0; // sizes from a sheet to the ends of edges that may pass through it
    std::vector<int> out;
    if (!any_sheet(reference))
        return out;
    std::vector<int> patch(cloud.count(), -1); // the sheet near an interior point
    std::vector<domain::Foot> feet(cloud.count());
    workers.for_each(cloud.count(), 512, [&](std::size_t i) {
        if (cloud.role[i] != Stratum::interior)
            return;
        feet[i] = reference.nearest(cloud.points[i], -1, cloud.near[i]);
        const int on = reference.data().patch[feet[i].triangle];
        if (reference.sheet(on) && feet[i].distance < close * cloud.size[i])
            patch[i] = on;
    });
    for (std::size_t t = 0; t < complex.all.tets.size(); ++t)
        for (const auto &[i, j] : kEdges) {
            const int v = complex.all.tets[t][i], w = complex.all.tets[t][j];
            if (complex.region[t] < 0 || patch[v] < 0 || patch[v] != patch[w])
                continue;
            const Vec3 n = reference.normal(feet[v].triangle); // triangles of a sheet may run either way
            const double above = dot(cloud.points[v] - feet[v].point, n),
                         below = dot(cloud.points[w] - feet[v].point, n);
            if (above * below >= 0.0)
                continue;
            const double share = above / (above - below);
            const Vec3 through = (1.0 - share) * cloud.points[v] + share * cloud.points[w];
            const double edge = norm(cloud.points[v] - cloud.points[w]);
            if (is_on(reference, patch[v], reference.nearest(through, patch[v]).distance, edge))
                out.push_back(std::fabs(above) < std::fabs(below) ? v : w);
        }
    sort_unique(out);
    return out;
}

} // namespace wct::sampling
