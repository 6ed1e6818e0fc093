#include "search/bad_tet_queue.h"

namespace wct::search {

void BadTetQueue::rebuild() {
    entries_.assign(complex_.tet_slots(), {});
    queue_ = {};
    bad_ = 0;
    std::vector<int> all;
    for (std::size_t t = 0; t < complex_.tet_slots(); ++t)
        all.push_back(static_cast<int>(t));
    update(all, 0);
}

void BadTetQueue::enqueue(int t) {
    entries_[t].ticket = static_cast<std::uint32_t>(random_.next() >> 32);
    queue_.push({entries_[t].failures, entries_[t].ticket, t});
}

int BadTetQueue::next() {
    for (;;) {
        const auto [failures, ticket, t] = queue_.top();
        const Entry &entry = entries_[t];
        if (entry.bad && entry.failures == failures && entry.ticket == ticket)
            return t;
        queue_.pop(); // left over from before it changed
    }
}

void BadTetQueue::failed(int t) {
    if (!entries_[t].bad)
        return;
    ++entries_[t].failures;
    enqueue(t);
}

void BadTetQueue::not_tried(int t) {
    if (!entries_[t].bad || entries_[t].failures == 0)
        return;
    --entries_[t].failures;
    enqueue(t);
}

void BadTetQueue::update(const std::vector<int> &changed, int failures) {
    entries_.resize(complex_.tet_slots());
    for (int t : changed) {
        Entry &entry = entries_[t];
        const bool bad = complex_.alive(t) && energy_.bad(complex_.energy(t)) && !complex_.ruled_out(t);
        if (bad == entry.bad)
            continue;
        entry.bad = bad;
        bad_ += bad ? 1 : -1;
        if (bad) {
            entry.failures = failures;
            enqueue(t);
        }
    }
}

} // namespace wct::search
