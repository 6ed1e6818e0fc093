// Whether facets run through each other.

#include "search/surface_watch.h"

#include "geometry/crossing_triangles.h"

#include <algorithm>

namespace wct::search {

/// Facets near their patch do not meet others but where the surface does. One that is beyond the tolerance may close a
/// slit, and what moves there get through its other side, though every tet stays positive.
bool SurfaceWatch::crossings_allow() {
    if (complex_.over_count() == 0 && loose <= 0.0)
        return true;
    const auto over = [](const Piece &piece) { return piece.was_over > 0.0 || piece.over > 0.0; };
    bool beyond = std::any_of(old_.begin(), old_.end(), over) || std::any_of(new_.begin(), new_.end(), over);
    std::vector<int> round; // vertices of the facets in question, but for the one that moves
    for (const auto *pieces : {&old_, &new_})
        for (const Piece &piece : *pieces)
            for (const int v : piece.key)
                if (v != vertex_ && std::find(round.begin(), round.end(), v) == round.end())
                    round.push_back(v);
    std::vector<const Beside *> staying; // each at the first of its vertices that is in question
    for (auto v = round.begin(); v != round.end(); ++v)
        for (const Beside &facet : beside(*v)) {
            const bool seen = std::any_of(facet.key.begin(), facet.key.end(),
                                          [&](int w) { return std::find(round.begin(), v, w) != v; });
            if (seen)
                continue;
            beyond = beyond || facet.over > 0.0;
            staying.push_back(&facet);
        }
    return !beyond || !run_through(new_, staying) || run_through(old_, staying);
}

/// Facets of one plane touch at most, so that others alone are looked at.
bool SurfaceWatch::run_through(const std::vector<Piece> &pieces, const std::vector<const Beside *> &others) {
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const Piece &piece = pieces[i];
        const auto through = [&](int patch, const std::array<Vec3, 3> &other) {
            return !(piece.planar && piece.patch == patch) && geometry::triangles_cross(piece.corners, other);
        };
        if (std::any_of(others.begin(), others.end(),
                        [&](const Beside *other) { return through(other->patch, other->corners); }) ||
            std::any_of(pieces.begin(), pieces.begin() + static_cast<std::ptrdiff_t>(i),
                        [&](const Piece &other) { return through(other.patch, other.corners); }))
            return true;
    }
    return false;
}

} // namespace wct::search
