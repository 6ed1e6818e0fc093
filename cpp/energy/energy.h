#pragma once

#include "base/vec3.h"

namespace wct::energy {

/// How far a tet is from being well-centered, as a smooth one-sided penalty:
///
///   E = sum over 4 facets  max(0, margin3 - h/R)^power3
///     + weight2 * sum over 12 facet angles  max(0, margin2 - cos)^power2
///     + weight_quality * sum over 4 facets  (h/R - 1/3)^2
///
/// with h the signed height of the circumcenter over a facet and R the circumradius. h/R > 0 on all four facets means
/// that the tet contains its circumcenter, cos > 0 at all twelve facet angles that its triangles are acute; 1/3 is the
/// value in the regular tet (VanderZee, Hirani, Guoy, Zharnitsky, Ramos, "Geometric and combinatorial properties of
/// well-centered triangulations in three and higher dimensions").
struct EnergyForm {
    double margin3 = 0.12;
    double power3 = 2.5;
    double margin2 = 0.08;
    double power2 = 2.5;
    double weight2 = 0.0;
    double weight_quality = 0.003;

    bool cosines() const { return weight2 != 0.0; }
};

/// Tets are measured kLanes at a time: the compiler turns each loop over lanes into the widest vectors of the machine.
/// Lanes never mix, so the results are the same bits whatever the width.
inline constexpr int kLanes = 8;

/// Flatness below which a tet counts as degenerate: det / (longest edge)^3.
inline constexpr double kDegenerate = 1e-5;

struct alignas(64) Lanes {
    double at[kLanes];
    double &operator[](int lane) { return at[lane]; }
    const double &operator[](int lane) const { return at[lane]; }
};

/// Corner coordinates of kLanes tets: corner[i][axis][lane].
struct TetLanes {
    Lanes corner[4][3];

    void set(int lane, int i, const Vec3 &point) {
        corner[i][0][lane] = point.x;
        corner[i][1][lane] = point.y;
        corner[i][2][lane] = point.z;
    }
    void set_all(int i, const Vec3 &point) {
        for (int lane = 0; lane < kLanes; ++lane)
            set(lane, i, point);
    }
};

/// What the penalties look at, and what the chain rule needs to pull their slopes back to the corners.
struct ShapeLanes {
    Lanes height[4];    // h/R over the facet opposite corner i
    Lanes cosine[12];   // facet angles, three by three
    Lanes flatness;     // det / (longest edge)^3
    Lanes normal[4][3]; // unit inward normal of facet i
    Lanes area_term[4]; // 1 / (16 area^2) of facet i
    Lanes center[3];    // circumcenter relative to corner 0
    Lanes inverse_radius;
    Lanes inverse_det;
    Lanes square[6]; // squared edges 01 02 03 12 13 23
    Lanes inverse_edge[6];
};

/// dE/d(height) and dE/d(cosine).
struct SlopeLanes {
    Lanes height[4];
    Lanes cosine[12];
};

/// dE/d(corner).
struct GradientLanes {
    Lanes corner[4][3];
};

/// Heights and flatness; cosines too if asked.
void measure(const TetLanes &tets, bool cosines, ShapeLanes &shape);

/// What each tet must keep to, and how much it counts.
struct TermLanes {
    Lanes flatness; // must stay above this,
    Lanes height;   // its smallest h/R above this,
    Lanes cosine;   // and its smallest cosine above this (looked at only if the form weighs cosines)
    Lanes weight;
};

/// Terms that bound nothing but the flatness, each tet counting once.
TermLanes flatness_terms(double flatness);

/// Energy per lane, and its slopes. Where a bound of `terms` is broken the energy is infinite and the slopes are zero.
void penalize(const ShapeLanes &shape, const EnergyForm &form, const TermLanes &terms, Lanes &energy,
              SlopeLanes &slopes);
/// The energy alone.
void penalize(const ShapeLanes &shape, const EnergyForm &form, const TermLanes &terms, Lanes &energy);

/// Pull slopes back to all four corners.
void differentiate(const TetLanes &tets, const ShapeLanes &shape, const SlopeLanes &slopes, bool cosines,
                   GradientLanes &gradient);

/// Pull slopes back to corner 0 alone, for a vertex that moves within its star.
void differentiate_first(const TetLanes &tets, const ShapeLanes &shape, const SlopeLanes &slopes, bool cosines,
                         Lanes gradient[3]);

/// The smallest h/R, the smallest cosine (1 unless asked for) and the flatness: all that counting needs.
struct WorstLanes {
    Lanes height;
    Lanes cosine;
    Lanes flatness;
};
void measure_worst(const TetLanes &tets, bool cosines, WorstLanes &worst);

} // namespace wct::energy
