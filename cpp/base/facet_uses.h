#pragma once

#include "base/cells.h"

#include <cstddef>
#include <span>
#include <vector>

namespace wct {

/// Which of some tets have a facet. The facets stand in rows by their least corner: many short rows are sorted in far
/// less time than one long one, or a table of hashes is filled.
class FacetUses {
  public:
    /// A facet as one tet has it.
    struct Use {
        Edge others; // its corners but the least, ascending
        std::int32_t half;

        int tet() const { return half / 4; }
        int corner() const { return half % 4; } // the one of the tet that is not in the facet
    };

    /// `points`: how many there are.
    FacetUses(std::span<const Tet> tets, std::size_t points);

    /// Of the facet with these corners, which ascend. The tets ascend too.
    std::span<const Use> of(const Facet &key) const;

    /// visit(key, uses) for every facet once, in the order of the keys.
    template <class Visit> void each(const Visit &visit) const {
        for (std::size_t v = 0; v + 1 < first_.size(); ++v)
            for (std::size_t k = first_[v], end = k; k < first_[v + 1]; k = end) {
                const Edge &others = uses_[k].others;
                while (end < first_[v + 1] && uses_[end].others == others)
                    ++end;
                visit(Facet{static_cast<std::int32_t>(v), others[0], others[1]}, std::span(uses_).subspan(k, end - k));
            }
    }

  private:
    std::vector<std::size_t> first_; // by point, of its row; one more than points
    std::vector<Use> uses_;
};

} // namespace wct
