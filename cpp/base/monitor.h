#pragma once

#include <cstdint>
#include <functional>

namespace wct {

/// Counts the work and lets the caller watch it and stop it.
///
/// The work is cut into stages, each with its share of the whole. The listener gets the done fraction and the number of
/// tets that miss the goal in the best positions so far; it returns false to stop, or throws. It is called once per
/// `period` evaluations, so neither how often nor when depends on the clock.
class Monitor {
  public:
    using Listener = std::function<bool(double done, std::int64_t bad)>;

    explicit Monitor(Listener listener) : listener_(std::move(listener)) {}

    /// The next stage takes this share of the whole.
    void begin(double share) {
        base_ += share_;
        share_ = share;
    }

    /// Count tet evaluations and say how much of the stage is done. Returns false once the work should stop.
    bool work(std::size_t evaluations, double stage_done) {
        evaluations_ += static_cast<std::int64_t>(evaluations);
        if (evaluations_ - reported_ >= kPeriod)
            report(base_ + share_ * stage_done);
        return !stopped_;
    }

    /// Tell the listener now.
    void report(double done) {
        reported_ = evaluations_;
        done_ = done;
        if (!stopped_ && listener_ && !listener_(done, bad_))
            stopped_ = true;
    }

    /// Let the listener stop what takes long, of which it is not known how much is done.
    void ask() { report(done_); }

    void iterate() { ++iterations_; }
    void set_bad(std::int64_t bad) { bad_ = bad; }

    bool stopped() const { return stopped_; }
    std::int64_t evaluations() const { return evaluations_; }
    std::int64_t iterations() const { return iterations_; }

  private:
    static constexpr std::int64_t kPeriod = 1 << 20;

    Listener listener_;
    double base_ = 0.0;
    double share_ = 0.0;
    double done_ = 0.0; // as was told last
    std::int64_t bad_ = 0;
    std::int64_t evaluations_ = 0;
    std::int64_t reported_ = 0;
    std::int64_t iterations_ = 0;
    bool stopped_ = false;
};

} // namespace wct
