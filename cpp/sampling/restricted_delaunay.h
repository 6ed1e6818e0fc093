#pragma once

#include "delaunay/delaunay.h"
#include "domain/reference.h"
#include "domain/region_map.h"
#include "sampling/cloud.h"

#include <array>
#include <vector>

namespace wct::sampling {

class HeldSurface;

/// The Delaunay tets of a cloud and the region each belongs to, -1 outside.
struct RestrictedDelaunay {
    delaunay::Triangulation all;
    std::vector<int> region;

    /// Corners of the facet of tet t opposite corner i, outward.
    std::array<int, 3> facet(int t, int i) const;
    /// Region across that facet.
    int beyond(int t, int i) const {
        const int n = all.neighbours[t][i];
        return n < 0 ? -1 : region[n];
    }
    /// Is the facet on the boundary, or on an interface and the tet is on the smaller region's side?
    bool on_surface(int t, int i) const {
        const int other = beyond(t, i);
        return region[t] >= 0 && (other < 0 || other > region[t]);
    }
};

/// Delaunay, each tet labelled by where its centroid lies; tets in a plane of the boundary, but for rounding, are out.
RestrictedDelaunay labelled_delaunay(const Cloud &cloud, const domain::RegionMap &map, const Workers &workers,
                                     const HeldSurface *held = nullptr);
/// The same, with slivers on curved patches taken off too. Tets on `held` facets belong to what is on that side of
/// them.
RestrictedDelaunay restricted_delaunay(const Cloud &cloud, const domain::Reference &reference,
                                       const domain::RegionMap &map, const Workers &workers,
                                       const HeldSurface *held = nullptr);

/// What is wrong with the surfaces of a complex.
struct Flaws {
    std::vector<int> exposed; // interior points on the surface
    std::vector<int> pinched; // points where the surface of a region is no disk
    bool none() const { return exposed.empty() && pinched.empty(); }
};
Flaws find_flaws(const Cloud &cloud, const RestrictedDelaunay &complex);

/// Facets of the boundary and the interfaces, each once, outward or out of the region with the smaller number.
std::vector<std::array<int, 3>> surface_facets(const RestrictedDelaunay &complex);

/// Edges of the boundary and the interfaces, each once, ends ascending.
std::vector<std::array<int, 2>> surface_edges(const RestrictedDelaunay &complex);

} // namespace wct::sampling
