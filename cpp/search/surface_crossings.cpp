// Whether facets run through each other.

#include "search/surface_watch.h"

#include "geometry/crossing_triangles.h"

#include <algorithm>

namespace wct::search {

namespace {

/// Whether the facets have an edge in common.
bool hinged(const Facet &f, const Facet &g) {
    return std::count_if(f.begin(), f.end(), [&](int v) { return v == g[0] || v == g[1] || v == g[2]; }) >= 2;
}

} // namespace

/// Facets near their patch do not meet others but where the surface does. One that is beyond the tolerance may close a
/// slit, and what moves there get through its other side, though every tet stays positive.
bool SurfaceWatch::crossings_allow() {
    if (complex_.over_count() == 0 && loose <= 0.0)
        return true;
    std::vector<int> round; // vertices of the facets in question, but for the one that moves
    for (const auto *pieces : {&old_, &new_})
        for (const Piece &piece : *pieces)
            for (const int v : piece.key)
                if (v != vertex_ && std::find(round.begin(), round.end(), v) == round.end())
                    round.push_back(v);
    const auto over = [](const Piece &piece) { return piece.was_over > 0.0 || piece.over > 0.0; };
    if (std::none_of(old_.begin(), old_.end(), over) && std::none_of(new_.begin(), new_.end(), over) &&
        std::none_of(round.begin(), round.end(), [&](int v) { return complex_.over_at(v) > 0; }))
        return true;
    std::vector<const Beside *> staying; // each at the first of its vertices that is in question
    for (auto v = round.begin(); v != round.end(); ++v)
        for (const Beside &facet : beside(*v))
            if (std::none_of(facet.key.begin(), facet.key.end(),
                             [&](int w) { return std::find(round.begin(), v, w) != v; }))
                staying.push_back(&facet);
    return !run_through(new_, staying) || run_through(old_, staying);
}

/// Facets of one plane, and those with a common edge, touch at most: the others are looked at.
bool SurfaceWatch::run_through(const std::vector<Piece> &pieces, const std::vector<const Beside *> &others) {
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const Piece &piece = pieces[i];
        const auto through = [&](const auto &other) {
            return !(piece.planar && piece.patch == other.patch) && !hinged(piece.key, other.key) &&
                   geometry::triangles_cross(piece.corners, other.corners);
        };
        if (std::any_of(others.begin(), others.end(), [&](const Beside *other) { return through(*other); }) ||
            std::any_of(pieces.begin(), pieces.begin() + static_cast<std::ptrdiff_t>(i), through))
            return true;
    }
    return false;
}

} // namespace wct::search
