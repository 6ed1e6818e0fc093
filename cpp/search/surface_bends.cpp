// How sharply facets bend.

#include "search/surface_watch.h"

#include <algorithm>
#include <cmath>

namespace wct::search {

namespace {

/// Radians by which facets may bend more than the surface that they are near. With 30 degrees, balls whose own facets
/// bend by 18 get edges that bend as creases do; with none, the search does not get past creases that fade out.
constexpr double kRough = 0.44;

/// Cosine of the angle by which two triangles bend at their edge ab, whose other corners are c and d: 1 in a plane.
double bend(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) {
    const Vec3 along = unit(b - a);
    const Vec3 p = c - a - dot(c - a, along) * along;
    const Vec3 q = d - a - dot(d - a, along) * along;
    return -dot(p, q) / (norm(p) * norm(q));
}

} // namespace

void SurfaceWatch::find_hinges(const std::vector<Piece> &pieces, bool all, std::vector<Hinge> &hinges) {
    const auto corner_off = [](const Facet &f, int a, int b) { // -1: the facet has no edge ab
        int off = -1, on = 0;
        for (int k = 0; k < 3; ++k)
            if (f[k] == a || f[k] == b)
                ++on;
            else
                off = k;
        return on == 2 ? off : -1;
    };
    hinges.clear();
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const Piece &piece = pieces[i];
        if (piece.planar)
            continue;
        for (int k = 0; k < 3; ++k) {
            const int a = piece.key[(k + 1) % 3], b = piece.key[(k + 2) % 3];
            if (!all && complex_.is_crease(a, b))
                continue;
            std::size_t j = 0;
            int off = -1;
            for (; j < pieces.size(); ++j)
                if (j != i && pieces[j].patch == piece.patch && (off = corner_off(pieces[j].key, a, b)) >= 0)
                    break;
            if (off >= 0) {
                if (i < j)
                    hinges.push_back({i, k, static_cast<int>(j), off, {}, {}});
                continue;
            }
            for (const Beside &facet : beside(a))
                if (facet.patch == piece.patch && (off = corner_off(facet.key, a, b)) >= 0) {
                    hinges.push_back({i, k, -1, -1, facet.corners[off], guide_.normal(piece.patch, facet.hint)});
                    break;
                }
        }
    }
}

double SurfaceWatch::sharpest(const std::vector<Piece> &pieces, const std::vector<Hinge> &hinges) const {
    double least = 1.0;
    for (const Hinge &hinge : hinges) {
        const Piece &piece = pieces[hinge.piece];
        const std::array<Vec3, 3> &c = piece.corners;
        const Piece *other = hinge.other >= 0 ? &pieces[hinge.other] : nullptr;
        const double is = bend(c[(hinge.corner + 1) % 3], c[(hinge.corner + 2) % 3], c[hinge.corner],
                               other ? other->corners[hinge.other_corner] : hinge.apex);
        if (is >= std::min(crease, least))
            continue;
        const Vec3 beyond = other ? guide_.normal(other->patch, other->hints[0]) : hinge.normal;
        if (std::acos(is) > angle(guide_.normal(piece.patch, piece.hints[0]), beyond) + kRough)
            least = is;
    }
    return least;
}

bool SurfaceWatch::bends_allow() {
    if (crease <= -1.0)
        return true;
    const bool moves = vertex_ >= 0; // then the hinges are the same wherever it is
    if (!moves || hinges_.empty())
        find_hinges(new_, false, hinges_);
    const double is = sharpest(new_, hinges_);
    if (is >= crease)
        return true;
    if (!moves)
        find_hinges(old_, true, hinges_);
    return is >= sharpest(old_, hinges_);
}

} // namespace wct::search
