#pragma once

#include "geometry/piece_tree.h"

#include <algorithm>
#include <cstdint>

namespace wct::geometry {

/// Whether all of a straight edge is near a set of segments or triangles. Shares of the tolerance: `at`, what the
/// places that are looked at stay within, and `all`, what everything between them stays within.
struct NearAlong {
    double at, all;

    /// Distance to one piece is convex: where it is small at both ends, so it is between them. So this goes on along
    /// each piece to where it is hardly near any more, found by Newton's method from the far side, and there to another
    /// that is nearer. `first`: a piece to try first, and where the beginning was found.
    template <class Tree>
    bool all_near(const Tree &tree, Vec3 a, const Vec3 &b, double tolerance, std::int32_t &first) const {
        constexpr int turns = 64; // an edge near more pieces than this, one after the other, is refused
        const double limit = at * at * tolerance * tolerance;
        const double within = all * all * tolerance * tolerance;
        const double hardly = 0.5 * (at + all) * tolerance;
        std::int32_t piece = tree.within(a, limit, first);
        if (piece < 0)
            return false;
        first = piece;
        // Mostly the edge runs over neighbours, one after the other, near each from where it gets there to where it
        // leaves.
        const Vec3 whole = b - a;
        double reached = 0.0;
        for (int turn = 0; turn < turns; ++turn) {
            const auto exit = tree.exit(piece, a, whole);
            if (exit.t >= 1.0) {
                const Vec3 gap = tree.gap(piece, b);
                if (dot(gap, gap) <= within)
                    return true;
                break;
            }
            const double t = std::max(reached, exit.t);
            const Vec3 x = a + t * whole;
            if (exit.neighbour < 0 || !tree.reaches(piece, x, limit))
                break;
            // The point of the piece closest to where it is left lies on the side both share.
            if (t > exit.t && !tree.reaches(exit.neighbour, x, limit))
                break;
            reached = t;
            piece = exit.neighbour;
        }
        a += reached * whole;
        for (int turn = 0; turn < turns; ++turn) {
            const Vec3 along = b - a;
            Vec3 x = b;
            Vec3 gap = tree.gap(piece, x);
            if (dot(gap, gap) <= within)
                return true;
            double t = 1.0;
            for (int step = 0; !(dot(gap, gap) <= within); ++step) {
                const double distance = norm(gap);
                const double slope = dot(gap, along) / distance;
                if (!(slope > 0.0) || step == turns)
                    return false;
                t -= (distance - hardly) / slope;
                x = a + t * along;
                gap = tree.gap(piece, x);
            }
            if (!(t > 0.0 && t < 1.0))
                return false;
            a = x;
            piece = tree.within(a, limit, piece);
            if (piece < 0)
                return false;
        }
        return false;
    }
};

} // namespace wct::geometry
