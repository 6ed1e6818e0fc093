#pragma once

#include "library/well_center.h"

#include <string_view>

namespace wct::library {

/// Passes on what phases tell of their progress, with the bad tets of the best mesh so far.
class Listener {
  public:
    using Progress = std::function<bool(const WellCenterProgress &)>;

    Listener(Progress progress, std::size_t bad) : progress_(std::move(progress)), bad_(bad) {}

    bool stopped() const { return stopped_; }
    /// Until a search takes a new mesh over, the best so far is the input.
    bool resampling(double done) { return tell("resampling", done); }
    bool searching(std::string_view phase, double done, int bad) {
        if (phase != "margin") // there, all that can meet the goal do
            bad_ = static_cast<std::size_t>(bad);
        return tell(phase, done);
    }

  private:
    bool tell(std::string_view stage, double done) {
        if (!stopped_ && progress_)
            stopped_ = !progress_({stage, done, bad_});
        return !stopped_;
    }

    Progress progress_;
    std::size_t bad_;
    bool stopped_ = false;
};

} // namespace wct::library
