#pragma once

#include <algorithm>
#include <array>

namespace wct::delaunay {

using Corners = std::array<int, 4>;

/// Where v stands among a tet's corners, or a tet among another's neighbours; 4 where it does not.
inline int place_of(const Corners &tet, int v) {
    return static_cast<int>(std::find(tet.begin(), tet.end(), v) - tet.begin());
}

} // namespace wct::delaunay
