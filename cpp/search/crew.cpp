#include "search/crew.h"

#include <algorithm>

namespace wct::search {

void Crew::gather(std::size_t tries) {
    constexpr std::size_t worth = 3000; // tets whose copy takes about as long as a try
    const std::size_t pays = tries * worth / std::max<std::size_t>(1, mesh().tets());
    helpers_.resize(std::min<std::size_t>(options_.workers.count() - 1, pays));
    options_.workers.for_each(helpers_.size(), 1,
                              [&](std::size_t k) { helpers_[k] = std::make_unique<Helper>(*this); });
}

bool Crew::reached(int tet, const Attempt &attempt) const {
    const auto claimed = [this](int v) { return static_cast<std::size_t>(v) < claims_.size() && claims_[v] == batch_; };
    return std::ranges::any_of(mesh().tet(tet), claimed) ||
           (attempt.change && std::ranges::any_of(attempt.change->touched, claimed));
}

std::vector<int> Crew::keep(const MeshChange &change) {
    claims_.resize(mesh().vertex_slots(), 0);
    for (const int v : change.touched)
        claims_[v] = batch_;
    for (const auto &helper : helpers_)
        helper->copy.apply(change);
    return own_.complex.apply(change);
}

void Crew::resum() {
    own_.complex.resum();
    for (const auto &helper : helpers_)
        helper->copy.resum();
}

} // namespace wct::search
