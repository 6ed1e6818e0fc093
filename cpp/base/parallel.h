#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace wct {

/// Runs loops on several threads.
///
/// Loops are cut into chunks of a size that does not depend on the number of threads, and each chunk writes to places
/// of its own: so the results are the same bits whatever the number.
class Workers {
  public:
    /// At least one: the caller's own.
    explicit Workers(unsigned threads = 1) : threads_(std::max(1u, threads)) {}

    unsigned count() const { return threads_; }

    /// Call body(first, last) for each chunk of 0..count, on any thread and in any order. Of what the chunks throw, the
    /// first one's is thrown again once no thread is at work any more.
    template <class Body> void for_chunks(std::size_t count, std::size_t chunk, const Body &body) const {
        const std::size_t chunks = (count + chunk - 1) / chunk;
        std::atomic<std::size_t> next{0};
        std::mutex guard;
        std::size_t failed = chunks;
        std::exception_ptr thrown;
        const auto work = [&] {
            for (std::size_t c = next++; c < chunks; c = next++)
                try {
                    body(c * chunk, std::min(count, (c + 1) * chunk));
                } catch (...) {
                    const std::lock_guard lock(guard);
                    if (c < failed) {
                        failed = c;
                        thrown = std::current_exception();
                    }
                }
        };
        const std::size_t helpers = std::min<std::size_t>(threads_, chunks);
        std::vector<std::thread> others;
        others.reserve(helpers); // so that nothing is thrown while threads are at work
        try {
            while (others.size() + 1 < helpers)
                others.emplace_back(work);
        } catch (const std::system_error &) { // the system has no more: those there are do it all
        }
        work();
        for (std::thread &other : others)
            other.join();
        if (thrown)
            std::rethrow_exception(thrown);
    }

    /// body(i) for each of 0..count.
    template <class Body> void for_each(std::size_t count, std::size_t chunk, const Body &body) const {
        for_chunks(count, chunk, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i)
                body(i);
        });
    }

    /// What must be added up in order: make(first, last, part) fills a part per chunk, on any thread; take(first, last,
    /// part) is called for one after the other, in their order, here. Few parts are held at a time.
    template <class Part, class Make, class Take>
    void in_order(std::size_t count, std::size_t chunk, const Make &make, const Take &take) const {
        const std::size_t held = chunk * (threads_ == 1 ? 1 : kHeld);
        std::vector<Part> parts((std::min(count, held) + chunk - 1) / chunk);
        for (std::size_t begin = 0; begin < count; begin += held) {
            const std::size_t some = std::min(held, count - begin);
            for_chunks(some, chunk, [&](std::size_t first, std::size_t last) {
                make(begin + first, begin + last, parts[first / chunk]);
            });
            for (std::size_t first = 0; first < some; first += chunk)
                take(begin + first, begin + std::min(some, first + chunk), parts[first / chunk]);
        }
    }

  private:
    static constexpr std::size_t kHeld = 16; // parts at a time
    unsigned threads_;
};

} // namespace wct
