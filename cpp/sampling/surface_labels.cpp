#include "sampling/surface_labels.h"

#include "sampling/curve_chains.h"
#include "sampling/held_surface.h"

#include <algorithm>
#include <map>

namespace wct::sampling {

namespace {

/// The patch all three corners belong to; of several, or of none, the nearest to the facet's centroid. A facet that is
/// none of the held ones belongs to a patch that is not held, if there is one.
int patch_of(const Cloud &cloud, const domain::Reference &reference, const Facet &facet, const HeldSurface *held) {
    std::vector<int> shared = shared_patches(cloud, reference, facet);
    if (held && shared.size() > 1)
        std::erase_if(shared, [&](int patch) { return held->holds_patch(patch); });
    if (shared.size() == 1)
        return shared[0];
    const Vec3 middle = (1.0 / 3.0) * (cloud.points[facet[0]] + cloud.points[facet[1]] + cloud.points[facet[2]]);
    if (shared.empty())
        return reference.data().patch[reference.nearest(middle).triangle];
    return *std::min_element(shared.begin(), shared.end(), [&](int a, int b) {
        return reference.nearest(middle, a).distance < reference.nearest(middle, b).distance;
    });
}

int curve_of(const Cloud &cloud, const domain::Reference &reference, const Edge &edge) {
    for (int v : edge)
        if (cloud.role[v] == Stratum::crease)
            return cloud.label[v];
    const Vec3 middle = 0.5 * (cloud.points[edge[0]] + cloud.points[edge[1]]);
    int best = -1;
    double distance = std::numeric_limits<double>::infinity();
    for (int k = 0; k < static_cast<int>(reference.curves().size()); ++k) {
        const double here = reference.nearest_on_curve(middle, k).distance;
        if (here < distance) {
            distance = here;
            best = k;
        }
    }
    return best;
}

/// Edges along curves that no change of patch tells of: those with one patch on both sides, as a crease has that fades
/// out on a smooth surface, or none, as wires have.
std::map<Edge, int> slits(const Cloud &cloud, const domain::Reference &reference) {
    std::map<Edge, int> edges;
    const auto chains = curve_chains(cloud, reference);
    for (int c = 0; c < static_cast<int>(chains.size()); ++c)
        if (reference.patches_at_curve(c).size() <= 1)
            for (std::size_t k = 0; k + 1 < chains[c].size(); ++k) {
                const int a = chains[c][k].point, b = chains[c][k + 1].point;
                edges.try_emplace(sorted(a, b), c);
            }
    return edges;
}

} // namespace

void free_buried(Cloud &cloud, const RestrictedDelaunay &complex, const domain::Reference &reference) {
    std::vector<char> open(cloud.count(), 0);
    for (const Facet &facet : surface_facets(complex))
        for (const int v : facet)
            open[v] = 1;
    for (std::size_t t = 0; t < complex.all.tets.size(); ++t) {
        if (complex.region[t] < 0)
            continue;
        for (const int v : complex.all.tets[t])
            if (!open[v] && cloud.role[v] != Stratum::interior && !patches_of(cloud, reference, v).empty()) {
                cloud.role[v] = Stratum::interior;
                cloud.label[v] = complex.region[t];
            }
    }
}

SurfaceLabels label_surface(const Cloud &cloud, const RestrictedDelaunay &complex, const domain::Reference &reference,
                            const HeldSurface *held) {
    SurfaceLabels out;
    struct Patches {
        int first;
        bool crease = false;
        int facets = 0;
    };
    std::map<Edge, Patches> edges; // ordered: the result does not depend on addresses
    out.facets = surface_facets(complex);
    const std::vector<int> given = held ? held->patches(cloud, out.facets) : std::vector<int>(out.facets.size(), -1);
    for (std::size_t f = 0; f < out.facets.size(); ++f) {
        const Facet &facet = out.facets[f];
        const int patch = given[f] >= 0 ? given[f] : patch_of(cloud, reference, facet, held);
        out.patch.push_back(patch);
        for (int k = 0; k < 3; ++k) {
            const int a = facet[k], b = facet[(k + 1) % 3];
            auto &seen = edges.try_emplace(sorted(a, b), Patches{patch}).first->second;
            seen.crease |= seen.first != patch || ++seen.facets > 2;
        }
    }
    const std::map<Edge, int> slit = slits(cloud, reference);
    for (const auto &[edge, curve] : slit)
        if (reference.patches_at_curve(curve).empty()) { // no facet has the edges of a wire
            out.creases.push_back(edge);
            out.curve.push_back(curve);
        }
    for (const auto &[edge, seen] : edges) {
        if (const auto found = slit.find(edge); found != slit.end()) {
            out.creases.push_back(edge);
            out.curve.push_back(found->second);
            continue;
        }
        if (!seen.crease || cloud.role[edge[0]] < Stratum::crease || cloud.role[edge[1]] < Stratum::crease)
            continue;
        const int curve = curve_of(cloud, reference, edge);
        if (curve < 0)
            continue;
        out.creases.push_back(edge);
        out.curve.push_back(curve);
    }
    return out;
}

} // namespace wct::sampling
