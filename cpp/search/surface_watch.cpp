#include "search/surface_watch.h"

#include <algorithm>
#include <limits>
#include <map>

namespace wct::search {

namespace {
constexpr double kUnfolded = 0.5; // cosine of the angle a facet may turn by in one move
/// The least, in tolerances, that a facet beyond the tolerance is said to be over: 0 would say that it is within.
constexpr double kLeast = 1e-6;
/// What is as far over as it was may come out this much farther.
constexpr double kRounding = 1.0 + 1e-9;
constexpr double kAcute = 0.035; // cosine of an angle of 88 degrees, above which no facet has a margin

std::array<double, 9> coordinates(const std::array<Vec3, 3> &c) {
    return {c[0].x, c[0].y, c[0].z, c[1].x, c[1].y, c[1].z, c[2].x, c[2].y, c[2].z};
}

} // namespace

SurfaceWatch::Piece SurfaceWatch::piece(const Facet &key, int patch) const {
    return {.key = key, .patch = patch, .planar = guide_.planar(patch), .corners = complex_.corners(key), .pull = {}};
}

SurfaceWatch::Piece SurfaceWatch::present(const Facet &key, const TetComplex::SurfaceFacet &facet) const {
    Piece out = piece(key, facet.patch);
    out.over = out.was_over = facet.over;
    out.hints = facet.hints;
    out.landmark = facet.landmark;
    return out;
}

void SurfaceWatch::begin() {
    complex_.forget_landmarks(); // of a search before this one
    std::map<int, std::vector<std::array<Vec3, 3>>> by_patch;
    std::map<std::array<double, 9>, Facet> known;
    for (const auto &[key, patch] : complex_.sorted_surface()) {
        if (guide_.planar(patch))
            continue;
        Piece one = piece(key, patch);
        by_patch[patch].push_back(one.corners);
        known.emplace(coordinates(one.corners), key);
        const bool near = guide_.near(patch, one.corners, one.edges, one.hints);
        complex_.set_over(key, near ? 0.0 : over(guide_.gap(patch, one.corners, one.hints).distance));
    }
    std::map<int, geometry::PieceTree<3>> trees;
    for (auto &[patch, corners] : by_patch)
        trees.emplace(patch, geometry::PieceTree<3>(std::move(corners)));
    std::map<int, std::int32_t> hints;
    for (std::size_t l = 0; l < guide_.landmarks().size(); ++l) {
        const auto &[point, patch, joined, tolerance] = guide_.landmarks()[l];
        const auto tree = trees.find(patch);
        if (tree == trees.end()) { // a patch too small to have got a facet
            complex_.add_landmark(std::nullopt);
            continue;
        }
        const auto found = tree->second.closest(point, hints[patch]);
        hints[patch] = found.piece;
        const auto &corners = tree->second.pieces()[found.piece];
        const Facet owner = known.at(coordinates(corners));
        complex_.add_landmark(owner);
        if (!guide_.covers(corners, static_cast<int>(l)))
            complex_.set_over(owner, std::max(complex_.over(owner),
                                              over(guide_.strict(static_cast<int>(l)) * norm(found.point - point))));
    }
}

void SurfaceWatch::clear() {
    vertex_ = -1;
    old_.clear();
    new_.clear();
    beside_.clear();
    hinges_.clear();
}

void SurfaceWatch::goes(const Facet &key) {
    old_.push_back(present(key, complex_.facet(key)));
}

void SurfaceWatch::comes(const Facet &key, int patch) {
    new_.push_back(piece(key, patch));
    for (const Piece &gone : old_) // it will be near where one of those was that it replaces
        if (gone.patch == patch)
            new_.back().hints.fill(gone.hints[0]);
}

/// An edge of a facet that goes stays where it was; an edge of two that come is looked at once.
void SurfaceWatch::skip_known_edges() {
    const auto has = [&](const Piece &piece, int patch, int a, int b) {
        const Facet &f = piece.key;
        return piece.patch == patch && (f[0] == a || f[1] == a || f[2] == a) && (f[0] == b || f[1] == b || f[2] == b);
    };
    for (std::size_t i = 0; i < new_.size(); ++i) {
        Piece &piece = new_[i];
        for (int k = 0; k < 3; ++k) {
            const int a = piece.key[k], b = piece.key[(k + 1) % 3];
            bool known = false;
            if (a != vertex_ && b != vertex_)
                known =
                    std::any_of(old_.begin(), old_.end(), [&](const Piece &p) { return has(p, piece.patch, a, b); });
            for (std::size_t j = 0; j < i && !known; ++j)
                known = has(new_[j], piece.patch, a, b);
            if (known)
                piece.edges &= ~(1u << k);
        }
    }
}

std::ptrdiff_t SurfaceWatch::undivided(const std::vector<Piece> &pieces) const {
    return std::count_if(pieces.begin(), pieces.end(), [&](const Piece &piece) {
        for (int k = 0; k < 3; ++k) {
            const int at = piece.key[k], a = piece.key[(k + 1) % 3], b = piece.key[(k + 2) % 3];
            if (complex_.vertex(at).stratum != Stratum::corner || !complex_.is_crease(at, a) ||
                !complex_.is_crease(at, b))
                continue;
            const Vec3 p = complex_.point(a) - complex_.point(at), q = complex_.point(b) - complex_.point(at);
            if (dot(p, q) < kAcute * norm(p) * norm(q))
                return true;
        }
        return false;
    });
}

bool SurfaceWatch::allows_replacing() {
    if (divides_corners && undivided(new_) > undivided(old_))
        return false;
    skip_known_edges();
    double allowed = loose; // no facet may be farther over than one it replaces
    for (const Piece &piece : old_)
        allowed = std::max(allowed, piece.was_over * kRounding);
    if (!std::all_of(new_.begin(), new_.end(), [&](Piece &piece) { return near(piece, allowed); }))
        return false;
    if (!landmarks_covered())
        return false;
    return std::none_of(new_.begin(), new_.end(), [&](const Piece &p) { return p.over > allowed; }) && bends_allow() &&
           crossings_allow();
}

bool SurfaceWatch::replace() {
    for (const Piece &piece : new_) {
        complex_.add_facet(piece.key, piece.patch);
        complex_.set_over(piece.key, piece.over);
        complex_.set_hints(piece.key, piece.hints);
    }
    for (const Handed &handed : handed_)
        complex_.hand_landmark(handed.landmark, handed.to);
    for (const Piece &piece : old_)
        complex_.remove_facet(piece.key);
    return std::any_of(new_.begin(), new_.end(), [](const Piece &p) { return p.over > 0.0; });
}

void SurfaceWatch::gather(int v) {
    clear();
    vertex_ = v;
    along_.clear();
    if (const Vertex &vertex = complex_.vertex(v); vertex.stratum == Stratum::crease && guide_.bare(vertex.label))
        for (const int t : complex_.star(v))
            for (const int w : complex_.tet(t))
                if (w != v && complex_.curve_of(v, w) == vertex.label &&
                    std::ranges::find(along_, w, &Along::end) == along_.end())
                    along_.push_back({w, guide_.allows_crease(vertex.label, vertex.position, complex_.point(w))
                                             ? 0.0
                                             : guide_.crease_gap(vertex.label, vertex.position, complex_.point(w))});
    complex_.surface_at(v, facets_);
    for (const auto &[key, facet] : facets_)
        old_.push_back(present(key, *facet));
    new_ = old_;
    suspect_ = 0;
    skip_known_edges();
    handed_.clear();
    allowed_.at = complex_.point(v);
    allowed_.pieces = new_;
    allowed_.handed.clear();
    if (std::any_of(old_.begin(), old_.end(), [](const Piece &p) { return p.over > 0.0; }))
        allows(allowed_.at); // so that cost and gradient are there
}

bool SurfaceWatch::creases_allow(const Vec3 &x) const {
    const int curve = complex_.vertex(vertex_).label;
    return std::ranges::all_of(along_, [&](const Along &edge) {
        const Vec3 &end = complex_.point(edge.end);
        return guide_.allows_crease(curve, x, end) ||
               (edge.gap > 0.0 && guide_.crease_gap(curve, x, end) <= edge.gap * kRounding);
    });
}

bool SurfaceWatch::allows(const Vec3 &x) {
    if (!creases_allow(x) || !facets_allow(x))
        return false;
    allowed_.at = x;
    allowed_.pieces = new_;
    allowed_.handed = handed_;
    return true;
}

bool SurfaceWatch::facets_allow(const Vec3 &x) {
    for (std::size_t i = 0; i < new_.size(); ++i) {
        Piece &piece = new_[i];
        for (int k = 0; k < 3; ++k)
            if (piece.key[k] == vertex_)
                piece.corners[k] = x;
        const Vec3 was = normal_of(old_[i].corners);
        const Vec3 is = normal_of(piece.corners);
        if (dot(was, is) <= kUnfolded * norm(was) * norm(is))
            return false;
    }
    for (std::size_t i = 0; i < new_.size(); ++i) {
        const std::size_t k = (suspect_ + i) % new_.size(); // what was refused last is likely to be refused again
        if (near(new_[k], std::max(loose, new_[k].was_over * kRounding)))
            continue;
        suspect_ = k;
        return false;
    }
    if (!landmarks_covered())
        return false;
    return std::none_of(new_.begin(), new_.end(),
                        [this](const Piece &p) { return p.over > std::max(loose, p.was_over * kRounding); }) &&
           bends_allow() && crossings_allow();
}

bool SurfaceWatch::near(Piece &piece, double allowed) const {
    piece.over = 0.0;
    piece.pull = {};
    if (piece.planar)
        return true;
    ++looks_;
    if (guide_.near(piece.patch, piece.corners, allowed > 0.0 ? 7u : piece.edges, piece.hints))
        return true;
    if (allowed <= 0.0)
        return false;
    const auto gap = guide_.gap(piece.patch, piece.corners, piece.hints, (1.0 + allowed) * guide_.tolerance());
    const auto &[a, b, c] = piece.corners;
    farther(piece, gap.distance, gap.weights.x * a + gap.weights.y * b + gap.weights.z * c,
            (gap.strict * gap.strict) * gap.to_surface);
    return piece.over <= allowed;
}

/// How far over the tolerance something at this distance is.
double SurfaceWatch::over(double distance) const {
    return std::max(kLeast, distance / guide_.tolerance() - 1.0);
}

/// The piece is this far away, as in SurfaceGuide::Gap, where its point `at` should go: `to_surface` is the way there,
/// times the square of how strict the place is, so that the pull is the gradient.
void SurfaceWatch::farther(Piece &piece, double distance, const Vec3 &at, const Vec3 &to_surface) const {
    if (over(distance) <= piece.over)
        return;
    piece.over = over(distance);
    if (vertex_ < 0)
        return;
    int k = 0;
    while (piece.key[k] != vertex_)
        ++k;
    const Vec3 &a = piece.corners[(k + 1) % 3];
    const Vec3 along = piece.corners[(k + 2) % 3] - a;
    const double weight = norm(cross(at - a, along)) / norm(cross(piece.corners[k] - a, along));
    piece.pull = distance > 0.0 ? (-weight / (distance * guide_.tolerance())) * to_surface : Vec3{};
}

double SurfaceWatch::cost(Vec3 *gradient) const {
    double sum = 0.0;
    for (const Piece &piece : new_)
        if (piece.over > 0.0) {
            sum += 1.0 + piece.over;
            if (gradient)
                *gradient += piece.pull;
        }
    return sum;
}

Vec3 SurfaceWatch::normal() const {
    Vec3 sum;
    for (const Piece &piece : old_) { // their corners are in the order of the key, so that any may face inwards
        const Vec3 n = normal_of(piece.corners);
        sum += (dot(n, sum) < 0.0 ? -1.0 : 1.0) * n;
    }
    return unit(sum);
}

bool SurfaceWatch::settle(const Vec3 &x) {
    if (!(allowed_.at == x) && !allows(x))
        return false;
    for (const Handed &handed : allowed_.handed)
        complex_.hand_landmark(handed.landmark, handed.to);
    for (const Piece &piece : allowed_.pieces) {
        complex_.set_over(piece.key, piece.over);
        complex_.set_hints(piece.key, piece.hints);
    }
    return true;
}

bool SurfaceWatch::landmarks_covered() {
    handed_.clear();
    for (std::size_t i = 0; i < old_.size(); ++i)
        if (!(vertex_ < 0 ? landmarks_left(i) : landmarks_covered(i)))
            return false;
    return true;
}

/// Those of a facet that goes.
bool SurfaceWatch::landmarks_left(std::size_t piece) {
    for (int l = old_[piece].landmark; l >= 0; l = complex_.next_landmark(l))
        if (!leave(l, piece))
            return false;
    return true;
}

/// Those of a facet that moves.
bool SurfaceWatch::landmarks_covered(std::size_t piece) {
    int l = old_[piece].landmark;
    if (l < 0)
        return true;
    const Facet &key = old_[piece].key;
    const std::array<Vec3, 3> &corners = new_[piece].corners;
    const geometry::TriangleFrame frame(corners);
    const auto &landmarks = guide_.landmarks();
    for (; l >= 0; l = complex_.next_landmark(l)) {
        // Distance to a facet is convex along a straight edge: it covers what is between two that it covers.
        if (l > 0 && landmarks[l - 1].joined && same(complex_.landmark_owner(l - 1), key))
            continue;
        int first = l, last = l;
        while (landmarks[last].joined && same(complex_.landmark_owner(last + 1), key))
            ++last;
        for (; first <= last && !guide_.covers(corners, frame, first); ++first)
            if (!leave(first, piece))
                return false;
        for (; first < last && !guide_.covers(corners, frame, last); --last)
            if (!leave(last, piece))
                return false;
    }
    return true;
}

/// Find another facet for a landmark of the piece, or note how far off the tolerance that is, if it may be.
bool SurfaceWatch::leave(int landmark, std::size_t piece) {
    if (cover(landmark, old_[piece]))
        return true;
    if (old_[piece].was_over <= 0.0 && loose <= 0.0)
        return false;
    Piece *owner = vertex_ >= 0 ? &new_[piece] : nearest(landmark, old_[piece].patch);
    if (!owner)
        return false;
    if (vertex_ < 0)
        handed_.push_back({landmark, owner->key});
    const Vec3 &point = guide_.landmarks()[landmark].point;
    const Vec3 foot = geometry::closest_on(owner->corners, point);
    const double strict = guide_.strict(landmark);
    farther(*owner, strict * norm(point - foot), foot, (strict * strict) * (point - foot));
    return true;
}

/// The facet that comes nearest to a landmark that none covers.
SurfaceWatch::Piece *SurfaceWatch::nearest(int landmark, int patch) {
    const Vec3 &point = guide_.landmarks()[landmark].point;
    Piece *best = nullptr;
    double distance = std::numeric_limits<double>::infinity();
    for (Piece &piece : new_) {
        const double here = norm(point - geometry::closest_on(piece.corners, point));
        if (piece.patch != patch || here >= distance)
            continue;
        distance = here;
        best = &piece;
    }
    return best;
}

/// Find a facet that covers a landmark its owner does not any more: one that comes, or one beside the owner.
bool SurfaceWatch::cover(int landmark, const Piece &owner) {
    for (const Piece &piece : new_)
        if (piece.patch == owner.patch && guide_.covers(piece.corners, landmark)) {
            handed_.push_back({landmark, piece.key});
            return true;
        }
    for (int v : owner.key) {
        if (v == vertex_)
            continue;
        for (const Beside &facet : beside(v))
            if (facet.patch == owner.patch && guide_.covers(facet.corners, landmark)) {
                handed_.push_back({landmark, facet.key});
                return true;
            }
    }
    return false;
}

const std::vector<SurfaceWatch::Beside> &SurfaceWatch::beside(int v) {
    for (const auto &[vertex, facets] : beside_)
        if (vertex == v)
            return facets;
    complex_.surface_at(v, facets_);
    auto &out = beside_.emplace_back(v, std::vector<Beside>{}).second;
    for (const auto &[key, facet] : facets_)
        if (std::none_of(old_.begin(), old_.end(), [&](const Piece &p) { return same(p.key, key); }))
            out.push_back({key, facet->patch, complex_.corners(key), facet->hints[0]});
    return out;
}

} // namespace wct::search
