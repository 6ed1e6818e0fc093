#pragma once

// With WCT_CHECKS defined, a search checks what it promises: after every commit what changed and all that is round it,
// every thousandth time and at the end all of the mesh. A broken promise throws std::logic_error with the names of the
// changes since the mark and the cells. Without WCT_CHECKS nothing of this is compiled.

#ifdef WCT_CHECKS
#define WCT_CHECK(...) __VA_ARGS__

#include <cstddef>
#include <vector>

namespace wct::search {

class SurfaceGuide;
class TetComplex;

/// What is done to a complex, and whether it is sound after it.
class CommitChecks {
  public:
    /// From now on commits are checked; before, a complex need not be a mesh.
    void start(const TetComplex &complex);
    /// Something was changed, by an operator of this name.
    void did(const char *name);
    void mark() { marks_.push_back(done_.size()); }
    void rollback();
    /// Before the last mark is forgotten.
    void commit(const TetComplex &complex);
    /// A search has ended: all of the mesh, the energies' sum and who owns the landmarks.
    void end(const TetComplex &complex, const SurfaceGuide &guide) const;

  private:
    void check_all(const TetComplex &complex) const;
    void check_changed(const TetComplex &complex) const;

    bool on_ = false;
    bool two_sided_ = true; // whether the tets at every facet lay on either side of it at the start
    long commits_ = 0;
    std::vector<const char *> done_; // since the outermost mark
    std::vector<std::size_t> marks_; // how many of them were done before each mark
};

} // namespace wct::search

#else
#define WCT_CHECK(...)
#endif
