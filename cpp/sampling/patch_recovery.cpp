#include "sampling/patch_recovery.h"

#include "base/sort_unique.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace wct::sampling {

namespace {

/// An interior point nearer to the patch than this, in sizes, goes.
constexpr double kClose = 0.7;
/// A point of another patch nearer than this goes, and points of the surface are not put closer to each other.
constexpr double kCrowded = 0.35;
/// Where the edge passes this near a crease, in sizes, the crease gets the point.
constexpr double kAtCrease = 0.3;

/// Where an edge passes through a patch.
struct Crossing {
    Vec3 at;
    std::array<double, 2> heights; // of the edge's ends over the plane of the triangle there
};

std::optional<Crossing> crossing(const Cloud &cloud, const domain::Reference &reference, int v, int w, int patch) {
    constexpr double flat = 1e-6; // edges: an end so near the plane is in it
    constexpr double bent = 0.15; // edges: so far a curved patch may be off the plane of one of its triangles
    const Vec3 &p = cloud.points[v], &q = cloud.points[w];
    const domain::Foot foot = reference.nearest(0.5 * (p + q), patch);
    const Vec3 &n = reference.normal(foot.triangle);
    const double above = dot(p - foot.point, n), below = dot(q - foot.point, n), edge = norm(p - q);
    if (!(above * below < 0.0) || std::min(std::fabs(above), std::fabs(below)) < flat * edge)
        return std::nullopt;
    const double share = above / (above - below);
    const Vec3 at = (1.0 - share) * p + share * q;
    if (reference.nearest(at, patch, foot.triangle).distance > (reference.planar(patch) ? flat : bent) * edge)
        return std::nullopt; // past its rim
    return Crossing{at, {std::fabs(above), std::fabs(below)}};
}

class PatchRecovery {
  public:
    PatchRecovery(Cloud &cloud, const domain::Reference &reference)
        : cloud_(cloud), reference_(reference), grid_(surface_grid(cloud, kCrowded)), keep_(cloud.count(), 1) {}

    /// The edge of the tet that passes through a patch of its other corners, if one does.
    void look_at(const Tet &tet) {
        std::array<std::vector<int>, 4> own;
        for (int i = 0; i < 4; ++i)
            own[i] = patches_of(cloud_, reference_, tet[i]);
        for (const auto &[i, j] : kEdges)
            for (int k = 0; k < 4; ++k)
                for (const int patch : own[k]) // of an end there is none that the ends do not have
                    if (!has(own[i], patch) && !has(own[j], patch) && mend(tet[i], tet[j], patch))
                        return;
    }

    int finish(const Workers &workers) {
        keep_.resize(cloud_.count(), 1);
        cloud_.keep(keep_);
        if (changes_)
            retract(cloud_, reference_, workers);
        return changes_;
    }

  private:
    static bool has(const std::vector<int> &patches, int patch) {
        return std::binary_search(patches.begin(), patches.end(), patch);
    }

    /// Whether the edge passes through the patch; then it will no more, if it may be changed.
    bool mend(int v, int w, int patch) {
        const auto found = crossing(cloud_, reference_, v, w, patch);
        if (!found)
            return false;
        if (!keep_[v] || !keep_[w])
            return true; // gone for another edge
        bool gone = false;
        for (const auto &[end, height] : {std::pair{v, found->heights[0]}, std::pair{w, found->heights[1]}})
            if (cloud_.held[end] < Hold::all && (reference_.inner(patch) || cloud_.role[end] == Stratum::interior) &&
                height < least_height(end)) {
                keep_[end] = 0;
                ++changes_;
                gone = true;
            }
        if (!gone)
            put(found->at, patch, 0.5 * (cloud_.size[v] + cloud_.size[w]));
        return true;
    }

    /// As near to the patch the point may be, for which there is no room beside those that the patch needs.
    double least_height(int v) const {
        const Stratum role = cloud_.role[v];
        const double share = role == Stratum::interior ? kClose : role == Stratum::patch ? kCrowded : 0.0;
        return share * cloud_.size[v];
    }

    void put(Vec3 at, int patch, double size) {
        Stratum role = Stratum::patch;
        int label = patch;
        const Vec3 passed = at;
        double least = kAtCrease * size;
        for (int curve = 0; curve < static_cast<int>(reference_.curves().size()); ++curve) {
            if (!has(reference_.patches_at_curve(curve), patch))
                continue;
            const domain::CurveFoot foot = reference_.nearest_on_curve(passed, curve);
            if (foot.distance < least) {
                least = foot.distance;
                role = Stratum::crease;
                label = curve;
                at = foot.point;
            }
        }
        if (grid_.crowded(at, kCrowded * size))
            return;
        grid_.add(at, kCrowded * size);
        cloud_.add(at, role, label, size);
        ++changes_;
    }

    Cloud &cloud_;
    const domain::Reference &reference_;
    PointGrid grid_;
    std::vector<char> keep_; // of the points there were at first
    int changes_ = 0;
};

/// Tets beside facets that cut across from one patch to another, and those that are astray: a plane that ends on
/// curved sides has an edge of theirs pass through it.
std::vector<int> tets_at_cuts(const Cloud &cloud, const domain::Reference &reference,
                              const RestrictedDelaunay &complex) {
    std::vector<int> tets;
    for (int t = 0; t < static_cast<int>(complex.all.tets.size()); ++t) {
        const Tet &tet = complex.all.tets[t];
        if (complex.region[t] >= 0 && is_astray(cloud, reference, tet, complex.region[t]) &&
            std::any_of(tet.begin(), tet.end(), [&](int v) { return on_curved(cloud, reference, v); }))
            tets.push_back(t);
        for (int i = 0; i < 4; ++i) {
            if (!complex.on_surface(t, i))
                continue;
            const Facet facet = complex.facet(t, i);
            if (std::any_of(facet.begin(), facet.end(), [&](int v) { return cloud.role[v] == Stratum::interior; }) ||
                !shared_patches(cloud, reference, facet).empty())
                continue;
            tets.push_back(t);
            if (complex.all.neighbours[t][i] >= 0)
                tets.push_back(complex.all.neighbours[t][i]);
        }
    }
    sort_unique(tets);
    return tets;
}

} // namespace

int recover_patches(Cloud &cloud, const domain::Reference &reference, const RestrictedDelaunay &complex,
                    const Workers &workers) {
    // Where parts meet in a notch shorter edges do not help, and outer patches get points too; in a body of one region
    // they do.
    if (!reference.has_inner())
        return 0;
    const std::vector<int> tets = tets_at_cuts(cloud, reference, complex);
    if (tets.empty())
        return 0;
    PatchRecovery recovery(cloud, reference);
    for (const int t : tets)
        recovery.look_at(complex.all.tets[t]);
    return recovery.finish(workers);
}

} // namespace wct::sampling
