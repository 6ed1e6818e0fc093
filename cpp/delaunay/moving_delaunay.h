#pragma once

#include "base/parallel.h"
#include "delaunay/delaunay.h"

#include <cstddef>
#include <memory>
#include <span>

namespace wct::delaunay {

class Mending;

/// The Delaunay tetrahedralization of points that move a little from time to time.
///
/// What is Delaunay still, stays: a look at every facet, by the predicates that build it, tells where it is not. There
/// the tets round it make way for those of their own vertices' Delaunay tetrahedralization, and for more where these do
/// not fit in. Where every tet is positive, every facet locally Delaunay and the hull convex, all of it is Delaunay
/// (Delaunay 1934): the tets are those of delaunay(), in another order.
class MovingDelaunay {
  public:
    MovingDelaunay();
    MovingDelaunay(MovingDelaunay &&) noexcept;
    MovingDelaunay &operator=(MovingDelaunay &&) noexcept;
    ~MovingDelaunay();

    /// That of the points, numbered as they were last; made anew where there are more or fewer of them, and where too
    /// much is to be mended. Throws as delaunay().
    Triangulation of(std::span<const Vec3> points, const Workers &workers = Workers());

    /// How often it was made anew.
    std::size_t made() const { return made_; }

  private:
    std::unique_ptr<Mending> kept_;
    std::size_t made_ = 0;
};

} // namespace wct::delaunay
