#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>

namespace wct::library {

/// How long a search may go on: counted in work, not in seconds, so that its result is the same on any machine.
class WorkLimit {
  public:
    /// `tets` of the mesh that came in.
    WorkLimit(std::size_t tets, int effort) : input_(tets), tets_(tets), effort_(effort) {}

    /// Work that is left, as of WorkUnits.
    long left() const {
        const double allowed = effort_ * (kBase + kPerTet * static_cast<double>(tets_));
        return std::max(0L, static_cast<long>(allowed) - spent_);
    }
    /// Allow for a result of so many tets: those of the best mesh so far, or of the first start.
    void lead_to(std::size_t tets) { tets_ = std::max(input_, tets); }
    /// Count a start, or a search.
    void add(long work) { spent_ += work; }

  private:
    /// Allowed whatever the size, and per tet of the larger of input and result: some 5 s and 5 ms per tet of one core.
    static constexpr double kBase = 75e6;
    static constexpr double kPerTet = 75e3;

    std::size_t input_, tets_;
    int effort_;
    long spent_ = 0;
};

/// How many tets a new mesh may have.
class TetLimit {
  public:
    /// `most`: as given; `came`: tets of the mesh that came in.
    TetLimit(std::optional<std::size_t> most, std::size_t came) : most_(most), came_(came) {}

    /// Whether a mesh of so many tets may be a start or a result.
    bool holds(std::size_t tets) const { return !most_ || tets <= *most_; }
    /// Whether to begin a start that is expected to have so many. The estimate is not off by more than a quarter.
    bool begins(double tets) const {
        return tets <=
               (most_ ? kSurely * static_cast<double>(*most_) : std::max(kMany, kTimes * static_cast<double>(came_)));
    }
    /// The most, or the largest number.
    std::size_t most() const { return most_.value_or(std::numeric_limits<std::size_t>::max()); }

  private:
    static constexpr double kSurely = 1.25;
    /// Where nobody named a limit: a layer of a thousandth of the body, or an edge length in the wrong unit, would take
    /// hours and all memory.
    static constexpr double kMany = 2e6, kTimes = 20.0;

    std::optional<std::size_t> most_;
    std::size_t came_;
};

} // namespace wct::library
