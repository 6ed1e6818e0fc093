#include "search/crew.h"

namespace wct::search {

void Crew::gather(std::size_t tries) {
    constexpr std::size_t worth = 3000; // tets whose copy takes about as long as a try
    const std::size_t pays = tries * worth / std::max<std::size_t>(1, mesh().tets());
    helpers_.resize(std::min<std::size_t>(options_.workers.count() - 1, pays));
    options_.workers.for_each(helpers_.size(), 1,
                              [&](std::size_t k) { helpers_[k] = std::make_unique<Helper>(*this); });
}

void Crew::apply(const MeshChange &change, std::vector<int> &changed) {
    own_.complex.mark();
    own_.complex.apply(change);
    own_.complex.changed(changed);
    WCT_CHECK(own_.complex.checks.did("apply");)
    own_.complex.commit();
    for (const auto &helper : helpers_) {
        helper->copy.mark();
        helper->copy.apply(change);
        helper->copy.commit();
    }
}

void Crew::resum() {
    own_.complex.resum();
    for (const auto &helper : helpers_)
        helper->copy.resum();
}

} // namespace wct::search
