#include "sampling/lost_domain.h"

#include "sampling/crease_recovery.h"
#include "sampling/sheets.h"

#include <algorithm>
#include <set>

namespace wct::sampling {

namespace {

bool keeps(const domain::Reference &reference, int patch, const domain::SizingForm &sizing) {
    return reference.keeps(patch, sizing.least_at(patch, reference));
}

/// Corners of facets that cut across from one planar patch to another: nothing brings such a facet back, as planes are
/// kept by keeping their vertices in them. Where single triangles of noise are patches, some are a little off; to give
/// up the whole start for them would cost far more.
std::vector<int> across_planes(const Cloud &cloud, const RestrictedDelaunay &complex,
                               const domain::Reference &reference, const domain::SizingForm &sizing) {
    constexpr double far = 4.0; // tolerances
    const auto off = [&](const Facet &facet) {
        const Vec3 &a = cloud.points[facet[0]], &b = cloud.points[facet[1]], &c = cloud.points[facet[2]];
        for (const Vec3 &p : {(1.0 / 3.0) * (a + b + c), 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)})
            if (reference.nearest(p).distance > far * sizing.tolerance)
                return true;
        return false;
    };
    const auto kept = [&](int v) {
        const std::vector<int> patches = patches_of(cloud, reference, v);
        return std::all_of(patches.begin(), patches.end(), [&](int p) { return keeps(reference, p, sizing); });
    };
    std::vector<int> corners;
    for (const auto &facet : surface_facets(complex))
        if (cuts_across(cloud, reference, facet) && (std::all_of(facet.begin(), facet.end(), kept) || off(facet)))
            corners.insert(corners.end(), facet.begin(), facet.end());
    return corners;
}

/// Ends of crease edges that are missing along wires, which are nothing else, and beside planes that are kept exactly.
/// Vertices are kept there by their labels, and facets by the creases between them: past a gap, facets would get from
/// one plane to the next.
std::vector<int> open_creases(const Cloud &cloud, const RestrictedDelaunay &complex, const domain::Reference &reference,
                              const domain::SizingForm &sizing) {
    std::vector<int> ends;
    for (const CreaseGap &gap : crease_gaps(cloud, reference, complex)) {
        const std::vector<int> &patches = reference.patches_at_curve(gap.curve);
        if (patches.empty() ||
            std::any_of(patches.begin(), patches.end(), [&](int p) { return keeps(reference, p, sizing); }))
            ends.insert(ends.end(), {gap.first, gap.second});
    }
    return ends;
}

} // namespace

std::vector<int> lost_points(const Cloud &cloud, const Flaws &flaws) {
    std::vector<int> lost = flaws.exposed;
    lost.insert(lost.end(), flaws.pinched.begin(), flaws.pinched.end());
    std::erase_if(lost, [&](int v) { return cloud.role[v] == Stratum::corner; });
    return lost;
}

std::vector<int> lost_planes(const Cloud &cloud, const RestrictedDelaunay &complex, const domain::Reference &reference,
                             const domain::SizingForm &sizing) {
    std::vector<int> lost = across_planes(cloud, complex, reference, sizing);
    const std::vector<int> open = open_creases(cloud, complex, reference, sizing);
    lost.insert(lost.end(), open.begin(), open.end());
    const std::vector<int> torn = torn_sheets(cloud, reference, complex);
    lost.insert(lost.end(), torn.begin(), torn.end());
    return lost;
}

std::vector<int> strange_contacts(const RestrictedDelaunay &complex, const domain::Reference &reference) {
    std::set<Edge> parted;
    for (const auto &[behind, before] : reference.data().sides)
        parted.insert(sorted(behind, before));
    std::vector<int> corners;
    for (int t = 0; t < static_cast<int>(complex.region.size()); ++t)
        for (int i = 0; i < 4; ++i)
            if (complex.on_surface(t, i) && !parted.contains(sorted(complex.region[t], complex.beyond(t, i)))) {
                const Facet facet = complex.facet(t, i);
                corners.insert(corners.end(), facet.begin(), facet.end());
            }
    return corners;
}

} // namespace wct::sampling
