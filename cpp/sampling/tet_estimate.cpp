#include "sampling/tet_estimate.h"

#include "sampling/lattice_levels.h"
#include "sampling/seeds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace wct::sampling {

namespace {

/// Over a piece of a simplex sizes are taken to be as in its middle. It is no longer than so many sizes there, or than
/// a share of the domain: more would take long where there are so many tets that a rough number does.
constexpr double kPiece = 2.0;
constexpr double kShortest = 0.03;

/// Call take(middle, size there, content) for the pieces of a simplex of so much content, halved at its longest edge.
template <std::size_t corners, class Take>
void cut(const std::array<Vec3, corners> &simplex, double content, const domain::Sizing &sizing, double shortest,
         const Take &take) {
    Vec3 middle{};
    for (const Vec3 &p : simplex)
        middle = middle + (1.0 / static_cast<double>(corners)) * p;
    std::size_t from = 0, to = 1;
    for (std::size_t i = 0; i < corners; ++i)
        for (std::size_t k = i + 1; k < corners; ++k)
            if (norm(simplex[k] - simplex[i]) > norm(simplex[to] - simplex[from])) {
                from = i;
                to = k;
            }
    const double size = sizing.at(middle);
    if (norm(simplex[to] - simplex[from]) <= std::max(kPiece * size, shortest)) {
        take(middle, size, content);
        return;
    }
    std::array<Vec3, corners> half = simplex, other = simplex;
    half[from] = other[to] = 0.5 * (simplex[from] + simplex[to]);
    cut(half, 0.5 * content, sizing, shortest, take);
    cut(other, 0.5 * content, sizing, shortest, take);
}

/// Sizes on the surface with the share of its points that they have.
std::vector<std::pair<double, double>> surface_sizes(const domain::Reference &reference, const domain::Sizing &sizing,
                                                     double shortest, const Workers &workers) {
    const auto &data = reference.data();
    std::vector<std::vector<std::pair<double, double>>> parts(data.triangles.size());
    workers.for_each(parts.size(), 64, [&](std::size_t t) {
        const auto &[a, b, c] = data.triangles[t];
        cut<3>({data.points[a], data.points[b], data.points[c]}, reference.area(static_cast<int>(t)), sizing, shortest,
               [&](const Vec3 &, double size, double area) { parts[t].emplace_back(size, area / (size * size)); });
    });
    std::vector<std::pair<double, double>> all;
    for (const auto &part : parts)
        all.insert(all.end(), part.begin(), part.end());
    std::sort(all.begin(), all.end());
    return all;
}

LatticeLevels levels_of(const std::vector<std::pair<double, double>> &sizes, const domain::Sizing &sizing) {
    double all = 0.0;
    for (const auto &[size, share] : sizes)
        all += share;
    double finest = sizing.smallest(), before = 0.0;
    for (const auto &[size, share] : sizes) {
        finest = size;
        before += share;
        if (SeedForm::outliers * before > all)
            break;
    }
    const double least = sizes.empty() ? finest : sizes.front().first;
    return {sizing, finest, least, SeedForm{}.edge_per_cell, SeedForm::level_ratio};
}

} // namespace

double estimate_tets(const domain::Reference &reference, const domain::InputMesh &mesh, const domain::Sizing &sizing,
                     const Workers &workers) {
    constexpr double per_cell = 12.0; // tets of a body-centered cubic lattice
    constexpr double skin = 0.6;      // sizes: no deeper than this are points of the surface, which are at no levels
    constexpr double filled = 0.91;   // of the lattice's number in meshes of 5 to 60 thousand tets, all within 0.13
    const double shortest = kShortest * reference.diagonal();
    const LatticeLevels levels = levels_of(surface_sizes(reference, sizing, shortest, workers), sizing);
    std::vector<double> parts(mesh.tets.size());
    workers.for_each(parts.size(), 64, [&](std::size_t t) {
        const auto &[a, b, c, d] = mesh.tets[t];
        const Vec3 &p = mesh.points[a], &q = mesh.points[b], &r = mesh.points[c], &s = mesh.points[d];
        const double volume = std::fabs(six_volumes(p, q, r, s)) / 6.0;
        cut<4>({p, q, r, s}, volume, sizing, shortest, [&](const Vec3 &middle, double size, double content) {
            double cell = size / SeedForm{}.edge_per_cell;
            if (levels.count() > 1 && reference.nearest(middle).distance > skin * size)
                cell = levels.cell(levels.of(size));
            parts[t] += per_cell * content / (cell * cell * cell);
        });
    });
    double sum = 0.0;
    for (const double one : parts)
        sum += one;
    return filled * sum;
}

} // namespace wct::sampling
