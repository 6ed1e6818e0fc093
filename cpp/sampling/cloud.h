#pragma once

#include "base/cells.h"
#include "base/parallel.h"
#include "base/vec3.h"
#include "domain/reference.h"

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace wct::sampling {

/// What leaves a point where it is: relaxation, descent as well, or all there is; a given one does not go either.
enum class Hold : std::uint8_t { none, relaxation, descent, all, given };

/// The points of a mesh in the making.
struct Cloud {
    std::vector<Vec3> points;
    std::vector<Stratum> role;
    std::vector<int> label;   // patch, curve, vertex of the surface; for interior points their region
    std::vector<double> size; // wanted edge length
    std::vector<int> near;    // a triangle of the reference not far from it, -1: none is known
    std::vector<Hold> held;
    std::vector<Vec3> drift; // how the last sweep of relaxation moved it

    std::size_t count() const { return points.size(); }
    void add(const Vec3 &p, Stratum s, int l, double h) {
        points.push_back(p);
        role.push_back(s);
        label.push_back(l);
        size.push_back(h);
        near.push_back(-1);
        held.push_back(Hold::none);
        drift.push_back({});
    }
    Vec3 centroid(const Tet &tet) const {
        Vec3 sum;
        for (const int v : tet)
            sum += 0.25 * points[v];
        return sum;
    }
    void keep(const std::vector<char> &which);
    void append(const Cloud &other);
};

/// The patches a point of the cloud belongs to, ascending.
std::vector<int> patches_of(const Cloud &cloud, const domain::Reference &reference, int point);
/// Whether any of these is curved.
bool on_curved(const Cloud &cloud, const domain::Reference &reference, int point);
/// The patches all of these points belong to (at least one), ascending.
std::vector<int> shared_patches(const Cloud &cloud, const domain::Reference &reference, std::span<const int> points);
/// Whether a facet cuts across from one planar patch to another: its corners share none, and no curved one is there.
bool cuts_across(const Cloud &cloud, const domain::Reference &reference, const Facet &facet);
/// Whether a tet of this region has a corner on a patch of others, as one does that lies on the rim where they meet, or
/// round an edge that passes through a plane beside it.
bool is_astray(const Cloud &cloud, const domain::Reference &reference, const Tet &tet, int region);

/// Which points are on wires, curves inside a region with no patch beside, their ends too.
std::vector<char> on_wires(const Cloud &cloud, const domain::Reference &reference);

/// Drop points that coincide with another: of two the one that is freer to move goes, else the later one, and no given
/// one. True if any did.
bool drop_twins(Cloud &cloud);

/// Put every boundary point where its role wants it, on curved patches at their offset.
void retract(Cloud &cloud, const domain::Reference &reference, const Workers &workers);
/// The same, but points of curved patches stay where they are within `shell` of their patch. `direction` receives the
/// patch's normal or the curve's tangent, zero for other points.
void retract_to_shell(Cloud &cloud, const domain::Reference &reference, double shell, std::vector<Vec3> &direction,
                      const Workers &workers);

/// Points with a radius each, for asking what is near: one hash grid per power of two of the radius.
class PointGrid {
  public:
    void add(const Vec3 &p, double radius);
    /// Is a point closer than the mean of its radius and this one, not counting those in the place `but`?
    bool crowded(const Vec3 &p, double radius, const Vec3 *but = nullptr) const { return crowded({p, radius, but}); }

  private:
    using Index = std::array<std::int64_t, 3>; // of a cell or a block, along the axes
    struct IndexHash {
        std::size_t operator()(const Index &index) const;
    };
    struct Item {
        Vec3 point;
        double radius;
    };
    struct Query {
        Vec3 point;
        double radius;
        const Vec3 *but; // nullptr: all points count
    };
    bool crowded(const Query &query) const;
    static constexpr int kBlocks = 3; // levels of blocks over the cells
    static constexpr int kShift = 4;  // two to that many of one level along an axis make a block of the next
    struct Level {
        double cell;
        std::unordered_map<Index, std::vector<Item>, IndexHash> cells;
        /// Those of the level below that are not empty, by block: where a query is far larger than the cells, whole
        /// blocks are out of its reach.
        std::array<std::unordered_map<Index, std::vector<Index>, IndexHash>, kBlocks> blocks;

        bool cell_hit(const Index &index, const Query &query) const;
        /// A block of a level, or a cell at level -1.
        bool block_hit(int level, const Index &index, const Query &query) const;
        bool reaches(int level, const Index &index, const Query &query) const;
    };
    std::vector<Level> levels_; // ascending cells
};

/// The surface's points, each with this share of its size for radius.
PointGrid surface_grid(const Cloud &cloud, double share);

} // namespace wct::sampling
