#pragma once

#include "base/cells.h"
#include "delaunay/corners.h"
#include "delaunay/moving_delaunay.h"
#include "domain/reference.h"
#include "domain/region_map.h"
#include "sampling/cloud.h"

#include <cstdint>
#include <vector>

namespace wct::sampling {

class HeldSurface;

/// The Delaunay tets of a cloud and the region each belongs to, -1 outside.
struct RestrictedDelaunay {
    delaunay::Triangulation all;
    std::vector<int> region;
    /// Per tet a bit for each facet that lies on a sheet, opposite the corner of that number; empty: there is no sheet.
    std::vector<std::uint8_t> sheets;

    /// Corners of the facet of tet t opposite corner i, outward.
    Facet facet(int t, int i) const;
    /// Region across that facet.
    int beyond(int t, int i) const {
        const int n = all.neighbours[t][i];
        return n < 0 ? -1 : region[n];
    }
    /// The corner of the tet across that facet which the facet lacks.
    int apex_beyond(int t, int i) const {
        const int n = all.neighbours[t][i];
        return all.tets[n][delaunay::place_of(all.neighbours[n], t)];
    }
    /// Add the tets that are inside, and their regions.
    void append_inside(std::vector<Tet> &tets, std::vector<int> &regions) const;
    bool on_sheet(int t, int i) const {
        return !sheets.empty() && (sheets[t] >> i & 1) && region[t] >= 0 && beyond(t, i) == region[t];
    }
    /// Is the facet on the boundary, or on an interface and the tet is on the smaller region's side, or on a sheet and
    /// the tet has the smaller number?
    bool on_surface(int t, int i) const {
        const int other = beyond(t, i);
        return region[t] >= 0 && (other < 0 || other > region[t] || (on_sheet(t, i) && t < all.neighbours[t][i]));
    }
};

/// Delaunay, each tet labelled by where its centroid lies; tets in a plane of the boundary, but for rounding, are out.
/// `moving`: what was made of the cloud when its points were elsewhere, and is to be made now; else from scratch.
RestrictedDelaunay labelled_delaunay(const Cloud &cloud, const domain::RegionMap &map, const Workers &workers,
                                     const HeldSurface *held = nullptr, delaunay::MovingDelaunay *moving = nullptr);
/// The same, with slivers on curved patches taken off too, and the facets that lie on sheets found. Tets on `held`
/// facets belong to what is on that side of them.
RestrictedDelaunay restricted_delaunay(const Cloud &cloud, const domain::Reference &reference,
                                       const domain::RegionMap &map, const Workers &workers,
                                       const HeldSurface *held = nullptr, delaunay::MovingDelaunay *moving = nullptr);

/// What is wrong with the surfaces of a complex.
struct Flaws {
    std::vector<int> exposed; // interior points on the surface
    std::vector<int> pinched; // points where the surface of a region is no disk
    bool none() const { return exposed.empty() && pinched.empty(); }
};
Flaws find_flaws(const Cloud &cloud, const RestrictedDelaunay &complex);

/// Euler characteristic of each region, numbered from 0. Where no surface is pinched it is half that of the region's
/// surface, which has far fewer cells to count.
std::vector<int> euler_characteristics(const RestrictedDelaunay &complex, const Flaws &flaws);

/// Facets of the boundary, the interfaces and the sheets, each once, outward or out of the region with the smaller
/// number.
std::vector<Facet> surface_facets(const RestrictedDelaunay &complex);

/// Their edges, each once, ends ascending.
std::vector<Edge> surface_edges(const RestrictedDelaunay &complex);

} // namespace wct::sampling
