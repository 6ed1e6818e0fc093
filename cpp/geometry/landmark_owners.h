#pragma once

#include <cstddef>
#include <vector>

namespace wct::geometry {

/// Landmarks, which are points of a surface that is to stay covered, by number, and what covers each: its owner, such
/// as a facet. Those of one owner are a list, which begins at a number that is kept with the owner, `first`; -1: none.
template <class Owner> class LandmarkOwners {
  public:
    int count() const { return static_cast<int>(links_.size()); }
    /// The next in the list of its owner, or -1.
    int next(int landmark) const { return links_[static_cast<std::size_t>(landmark)].next; }
    const Owner &owner(int landmark) const { return links_[static_cast<std::size_t>(landmark)].owner; }

    /// The next number, as yet without an owner.
    int add() {
        links_.emplace_back();
        return count() - 1;
    }
    void clear() { links_.clear(); }
    /// The one before in the list of its owner, or -1.
    int previous(int landmark) const { return links_[static_cast<std::size_t>(landmark)].previous; }
    /// Put it in the list of an owner, after the landmark `after`; -1: first. It must be in no list.
    void own(int landmark, const Owner &owner, int &first, int after = -1) {
        int &place = after < 0 ? first : links_[static_cast<std::size_t>(after)].next;
        links_[static_cast<std::size_t>(landmark)] = {owner, place, after};
        if (place >= 0)
            links_[static_cast<std::size_t>(place)].previous = landmark;
        place = landmark;
    }
    /// Take it out of the list of its owner.
    void disown(int landmark, int &first) {
        const Link &gone = links_[static_cast<std::size_t>(landmark)];
        if (gone.previous >= 0)
            links_[static_cast<std::size_t>(gone.previous)].next = gone.next;
        else
            first = gone.next;
        if (gone.next >= 0)
            links_[static_cast<std::size_t>(gone.next)].previous = gone.previous;
    }

  private:
    struct Link {
        Owner owner{};
        int next = -1, previous = -1;
    };
    std::vector<Link> links_;
};

} // namespace wct::geometry
