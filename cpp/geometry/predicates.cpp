#include "geometry/predicates.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace wct::geometry {

namespace {

/// The digits of a whole number in base 2^32, lowest first. Held in place: an insphere determinant takes a hundred
/// numbers, and a grid asks for several exact ones per point.
class Digits {
  public:
    Digits() = default;
    Digits(const Digits &other) { *this = other; }
    Digits &operator=(const Digits &other) {
        size_ = other.size_;
        std::copy_n(other.digits_.begin(), size_, digits_.begin());
        return *this;
    }

    int size() const { return size_; }
    std::uint32_t operator[](int i) const { return digits_[i]; }
    std::uint32_t &operator[](int i) { return digits_[i]; }
    void push(std::uint32_t digit) { digits_[size_++] = digit; }
    void zero(int size) {
        size_ = size;
        std::fill_n(digits_.begin(), size, 0u);
    }
    /// Afterwards no digit leads that is zero.
    void trim() {
        while (size_ > 0 && digits_[size_ - 1] == 0)
            --size_;
    }

  private:
    // One coordinate spans at most 2098 bits (2^-1074 to 2^1024), a product of six 12588, and sums add a few.
    static constexpr int kMost = 400;
    int size_ = 0;
    std::array<std::uint32_t, kMost> digits_; // only the first size_ are set
};

/// A whole number of any size, as much of one as a determinant needs.
class Integer {
  public:
    Integer() = default;

    /// value * 2^-exponent, for an exponent no greater than that of split(value).
    Integer(double value, int exponent) : negative_(value < 0.0) {
        if (value == 0.0)
            return;
        const auto [mantissa, lowest] = split(value);
        const int shift = lowest - exponent;
        digits_.zero(shift / 32);
        const int rest = shift % 32;
        const std::uint64_t low = mantissa << rest;
        const std::uint64_t high = rest ? mantissa >> (64 - rest) : 0;
        for (const std::uint64_t part : {low, low >> 32, high})
            digits_.push(static_cast<std::uint32_t>(part));
        digits_.trim();
    }

    /// |value| = first * 2^second, the first odd, for a value that is not zero.
    static std::pair<std::uint64_t, int> split(double value) {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        const auto exponent = static_cast<int>(bits >> 52 & 0x7ff);
        std::uint64_t mantissa = bits & 0xfffffffffffff;
        if (exponent)
            mantissa |= std::uint64_t{1} << 52;
        const int zeros = std::countr_zero(mantissa);
        return {mantissa >> zeros, std::max(exponent, 1) - 1075 + zeros};
    }

    int sign() const { return digits_.size() == 0 ? 0 : negative_ ? -1 : 1; }

    friend Integer operator-(const Integer &x) {
        Integer out = x;
        out.negative_ = !x.negative_;
        return out;
    }

    friend Integer operator+(const Integer &x, const Integer &y) { return total(x, y, y.negative_); }
    friend Integer operator-(const Integer &x, const Integer &y) { return total(x, y, !y.negative_); }

    friend Integer operator*(const Integer &x, const Integer &y) {
        Integer out;
        out.negative_ = x.negative_ != y.negative_;
        out.digits_.zero(x.digits_.size() + y.digits_.size());
        for (int i = 0; i < x.digits_.size(); ++i) {
            std::uint64_t carry = 0;
            for (int j = 0; j < y.digits_.size(); ++j) {
                carry += std::uint64_t{x.digits_[i]} * y.digits_[j] + out.digits_[i + j];
                out.digits_[i + j] = static_cast<std::uint32_t>(carry);
                carry >>= 32;
            }
            out.digits_[i + y.digits_.size()] = static_cast<std::uint32_t>(carry);
        }
        out.digits_.trim();
        return out;
    }

  private:
    /// x + y, y taken with the sign given.
    static Integer total(const Integer &x, const Integer &y, bool y_negative) {
        Integer out;
        if (x.negative_ == y_negative) {
            sum(x.digits_, y.digits_, out.digits_);
            out.negative_ = y_negative;
        } else if (less(x.digits_, y.digits_)) {
            difference(y.digits_, x.digits_, out.digits_);
            out.negative_ = y_negative;
        } else {
            difference(x.digits_, y.digits_, out.digits_);
            out.negative_ = x.negative_;
        }
        return out;
    }

    static bool less(const Digits &x, const Digits &y) {
        if (x.size() != y.size())
            return x.size() < y.size();
        for (int i = x.size() - 1; i >= 0; --i)
            if (x[i] != y[i])
                return x[i] < y[i];
        return false;
    }

    static void sum(const Digits &x, const Digits &y, Digits &out) {
        std::uint64_t carry = 0;
        for (int i = 0; i < std::max(x.size(), y.size()) || carry; ++i) {
            carry += (i < x.size() ? x[i] : 0ull) + (i < y.size() ? y[i] : 0ull);
            out.push(static_cast<std::uint32_t>(carry));
            carry >>= 32;
        }
    }

    /// x - y for x >= y.
    static void difference(const Digits &x, const Digits &y, Digits &out) {
        std::int64_t carry = 0;
        for (int i = 0; i < x.size(); ++i) {
            carry += std::int64_t{x[i]} - (i < y.size() ? std::int64_t{y[i]} : 0);
            out.push(static_cast<std::uint32_t>(carry));
            carry >>= 32; // arithmetic: -1 where a digit was borrowed
        }
        out.trim();
    }

    bool negative_ = false;
    Digits digits_;
};

#ifdef __SIZEOF_INT128__
/// A whole number of N 64-bit limbs, lowest first, in two's complement. Where the coordinates allow it, it takes a
/// tenth of Integer's time.
template <std::size_t N> struct Wide {
    std::array<std::uint64_t, N> limbs;

    int sign() const {
        if (limbs[N - 1] >> 63)
            return -1;
        return std::any_of(limbs.begin(), limbs.end(), [](std::uint64_t limb) { return limb != 0; });
    }

    friend Wide operator+(Wide x, const Wide &y) {
        x.add(y.limbs, 0, 0);
        return x;
    }

    friend Wide operator-(Wide x, const Wide &y) {
        x.add(y.limbs, 0, ~std::uint64_t{0});
        return x;
    }

    template <std::size_t M> friend Wide<N + M> operator*(const Wide &x, const Wide<M> &y) {
        Wide<N + M> out{};
        for (std::size_t i = 0; i < N; ++i) {
            unsigned __int128 carry = 0;
            for (std::size_t j = 0; j < M; ++j) {
                carry += static_cast<unsigned __int128>(x.limbs[i]) * y.limbs[j] + out.limbs[i + j];
                out.limbs[i + j] = static_cast<std::uint64_t>(carry);
                carry >>= 64;
            }
            out.limbs[i + M] = static_cast<std::uint64_t>(carry);
        }
        // Read as unsigned, a negative factor was 2^(64 limbs) too great.
        if (x.limbs[N - 1] >> 63)
            out.add(y.limbs, N, ~std::uint64_t{0});
        if (y.limbs[M - 1] >> 63)
            out.add(x.limbs, M, ~std::uint64_t{0});
        return out;
    }

    /// Adds the other limbs from limb `first` on, modulo 2^(64 N); subtracts them if `flip` has all its bits set.
    template <std::size_t M>
    void add(const std::array<std::uint64_t, M> &other, std::size_t first, std::uint64_t flip) {
        unsigned __int128 carry = flip & 1;
        for (std::size_t i = 0; i < M; ++i) {
            carry += static_cast<unsigned __int128>(limbs[first + i]) + (other[i] ^ flip);
            limbs[first + i] = static_cast<std::uint64_t>(carry);
            carry >>= 64;
        }
    }
};
#endif

/// The determinant of three edges, given along each axis.
template <class T> auto determinant(const std::array<T, 3> &x, const std::array<T, 3> &y, const std::array<T, 3> &z) {
    return x[0] * (y[1] * z[2] - y[2] * z[1]) + x[1] * (y[2] * z[0] - y[0] * z[2]) + x[2] * (y[0] * z[1] - y[1] * z[0]);
}

/// The insphere determinant of four corners less the point asked for, given along each axis.
template <class T>
auto lifted_determinant(const std::array<T, 4> &x, const std::array<T, 4> &y, const std::array<T, 4> &z) {
    const auto minor = [&](int i, int j) { return x[i] * y[j] - x[j] * y[i]; };
    const auto lift = [&](int i) { return x[i] * x[i] + y[i] * y[i] + z[i] * z[i]; };
    const auto ab = minor(0, 1);
    const auto bc = minor(1, 2);
    const auto cd = minor(2, 3);
    const auto da = minor(3, 0);
    const auto ac = minor(0, 2);
    const auto bd = minor(1, 3);
    return ((z[1] * cd - z[2] * bd + z[3] * bc) * lift(0) - (z[2] * da + z[3] * ac + z[0] * cd) * lift(1)) +
           ((z[3] * ab + z[0] * bd + z[1] * da) * lift(2) - (z[0] * bc - z[1] * ac + z[2] * ab) * lift(3));
}

/// All values but the first, less the first, in units of 2^exponent, of which all must be multiples.
template <std::size_t N> std::array<Integer, N - 1> edges_along(const std::array<double, N> &values, int exponent) {
    const Integer origin(values[0], exponent);
    std::array<Integer, N - 1> out;
    for (std::size_t i = 1; i < N; ++i)
        out[i - 1] = Integer(values[i], exponent) - origin;
    return out;
}

#ifdef __SIZEOF_INT128__
/// The same if all are below 2^61, so that no determinant overflows: a minor stays below 2^123, the sum of three times
/// an edge below 2^186, a squared length below 2^124, the sum of four products of these below 2^312. False otherwise.
template <std::size_t N>
bool short_edges_along(const std::array<double, N> &values, int exponent, std::array<Wide<1>, N - 1> &out) {
    std::array<__int128, N> whole{};
    for (std::size_t i = 0; i < N; ++i) {
        if (values[i] == 0.0)
            continue;
        const auto [mantissa, lowest] = Integer::split(values[i]);
        if (lowest - exponent > 72)
            return false;
        whole[i] = static_cast<__int128>(mantissa) << (lowest - exponent);
        if (values[i] < 0.0)
            whole[i] = -whole[i];
    }
    constexpr __int128 limit = static_cast<__int128>(1) << 61;
    for (std::size_t i = 1; i < N; ++i) {
        const __int128 edge = whole[i] - whole[0];
        if (edge >= limit || edge <= -limit)
            return false;
        out[i - 1].limbs[0] = static_cast<std::uint64_t>(edge);
    }
    return true;
}
#endif

/// The exponent given, or if less that of the greatest power of two of which all the values are multiples.
template <std::size_t N> int common_exponent(const std::array<double, N> &values, int exponent = 1024) {
    for (const double value : values)
        if (value != 0.0)
            exponent = std::min(exponent, Integer::split(value).second);
    return exponent;
}

int orient3d_exact(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) {
    // Each axis in a unit of its own: that scales the determinant and leaves its sign.
    const std::array<double, 4> x{a.x, b.x, c.x, d.x};
    const std::array<double, 4> y{a.y, b.y, c.y, d.y};
    const std::array<double, 4> z{a.z, b.z, c.z, d.z};
    const int of_x = common_exponent(x);
    const int of_y = common_exponent(y);
    const int of_z = common_exponent(z);
#ifdef __SIZEOF_INT128__
    std::array<Wide<1>, 3> u, v, w;
    if (short_edges_along(x, of_x, u) && short_edges_along(y, of_y, v) && short_edges_along(z, of_z, w))
        return determinant(u, v, w).sign();
#endif
    return determinant(edges_along(x, of_x), edges_along(y, of_y), edges_along(z, of_z)).sign();
}

int insphere_exact(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d, const Vec3 &e) {
    // Squared lengths mix the axes, so all are in the same unit.
    const std::array<double, 5> x{e.x, a.x, b.x, c.x, d.x};
    const std::array<double, 5> y{e.y, a.y, b.y, c.y, d.y};
    const std::array<double, 5> z{e.z, a.z, b.z, c.z, d.z};
    const int unit = common_exponent(x, common_exponent(y, common_exponent(z)));
#ifdef __SIZEOF_INT128__
    std::array<Wide<1>, 4> u, v, w;
    if (short_edges_along(x, unit, u) && short_edges_along(y, unit, v) && short_edges_along(z, unit, w))
        return lifted_determinant(u, v, w).sign();
#endif
    return lifted_determinant(edges_along(x, unit), edges_along(y, unit), edges_along(z, unit)).sign();
}

/// Vectors of whole numbers: an Integer each, or so many limbs.
template <class T> using Whole3 = std::array<T, 3>;

template <class T> Whole3<T> sum(const Whole3<T> &a, const Whole3<T> &b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class T> Whole3<T> difference(const Whole3<T> &a, const Whole3<T> &b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class S, class T> auto product(const S &s, const Whole3<T> &a) {
    return Whole3<decltype(s * a[0])>{s * a[0], s * a[1], s * a[2]};
}
template <class S, class T> auto dot(const Whole3<S> &a, const Whole3<T> &b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T> auto cross(const Whole3<T> &a, const Whole3<T> &b) {
    return Whole3<decltype(a[0] * b[0])>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                         a[0] * b[1] - a[1] * b[0]};
}

/// What `decide` says of the vectors from the first point to the others, in a unit in which they are whole numbers,
/// which changes no sign. Short ones are below 2^61, so that normals stay below 2^123, sums of three of them below
/// 2^125, squared lengths below 2^124, products of these, summed, below 2^249, and those with normals below 2^377.
template <std::size_t N, class Decide> bool decided(const std::array<Vec3, N> &points, const Decide &decide) {
    std::array<double, N> x{}, y{}, z{};
    for (std::size_t i = 0; i < N; ++i) {
        x[i] = points[i].x;
        y[i] = points[i].y;
        z[i] = points[i].z;
    }
    const int unit = common_exponent(x, common_exponent(y, common_exponent(z)));
    const auto by_point = [&]<class T>(const std::array<T, N - 1> &u, const std::array<T, N - 1> &v,
                                       const std::array<T, N - 1> &w) {
        std::array<Whole3<T>, N - 1> out;
        for (std::size_t i = 0; i + 1 < N; ++i)
            out[i] = {u[i], v[i], w[i]};
        return out;
    };
#ifdef __SIZEOF_INT128__
    std::array<Wide<1>, N - 1> u, v, w;
    if (short_edges_along(x, unit, u) && short_edges_along(y, unit, v) && short_edges_along(z, unit, w))
        return decide(by_point(u, v, w));
#endif
    return decide(by_point(edges_along(x, unit), edges_along(y, unit), edges_along(z, unit)));
}

/// The largest magnitude along each axis.
Vec3 reach(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) {
    const auto most = [](double p, double q, double r, double s) {
        return std::max(std::max(std::fabs(p), std::fabs(q)), std::max(std::fabs(r), std::fabs(s)));
    };
    return {most(a.x, b.x, c.x, d.x), most(a.y, b.y, c.y, d.y), most(a.z, b.z, c.z, d.z)};
}

} // namespace

int orient3d(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) {
    const Vec3 u = b - a;
    const Vec3 v = c - a;
    const Vec3 w = d - a;
    const double det = dot(u, cross(v, w));
    const double size = std::fabs(u.x) * (std::fabs(v.y * w.z) + std::fabs(v.z * w.y)) +
                        std::fabs(u.y) * (std::fabs(v.z * w.x) + std::fabs(v.x * w.z)) +
                        std::fabs(u.z) * (std::fabs(v.x * w.y) + std::fabs(v.y * w.x));
    // Bound A of Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates" (1997),
    // and what underflow may lose: less than 1e-323 in each product of v and w, which u then multiplies. An overflow
    // leaves infinity or NaN, which fails the comparison.
    constexpr double unit = 0x1p-53;
    constexpr double bound = (7.0 + 56.0 * unit) * unit;
    const double lost = 1e-290 * (1.0 + (std::fabs(u.x) + std::fabs(u.y) + std::fabs(u.z)));
    if (std::fabs(det) > bound * size + lost && std::isfinite(size))
        return det > 0.0 ? 1 : -1;
    return orient3d_exact(a, b, c, d);
}

int insphere(const Vec3 &p, const Vec3 &q, const Vec3 &r, const Vec3 &s, const Vec3 &e) {
    const Vec3 a = p - e;
    const Vec3 b = q - e;
    const Vec3 c = r - e;
    const Vec3 d = s - e;
    const double det = lifted_determinant<double>({a.x, b.x, c.x, d.x}, {a.y, b.y, c.y, d.y}, {a.z, b.z, c.z, d.z});
    // Bound A of Shewchuk's insphere, his sum of 4 * 6 absolute terms replaced by what it is at most; the last factor
    // covers the rounding of the bound itself. Within the limits on the reach nothing overflows, and what underflows
    // is far below the bound.
    const Vec3 m = reach(a, b, c, d);
    constexpr double unit = 0x1p-53;
    constexpr double bound = 24.0 * (16.0 + 224.0 * unit) * unit * 1.0001;
    const double least = std::min(m.x, std::min(m.y, m.z));
    const double most = std::max(m.x, std::max(m.y, m.z));
    if (std::fabs(det) > bound * (m.x * m.y * m.z) * dot(m, m) && least > 1e-60 && most < 1e60)
        return det > 0.0 ? 1 : -1;
    return insphere_exact(p, q, r, s, e);
}

bool contains_circumcenter(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) {
    return decided<4>({a, b, c, d}, [](const auto &edges) {
        const auto &[u, v, w] = edges;
        const auto n1 = cross(v, w);
        const auto n2 = cross(w, u);
        const auto n3 = cross(u, v);
        // 2 det times the circumcenter, seen from the first corner; the heights over the facets have the signs below.
        const auto center = sum(sum(product(dot(u, u), n1), product(dot(v, v), n2)), product(dot(w, w), n3));
        const auto det = dot(u, n1);
        const auto square = det * det;
        return dot(n1, center).sign() > 0 && dot(n2, center).sign() > 0 && dot(n3, center).sign() > 0 &&
               (square + square - dot(sum(sum(n1, n2), n3), center)).sign() > 0;
    });
}

bool acute(const Vec3 &a, const Vec3 &b, const Vec3 &c) {
    return decided<3>({a, b, c}, [](const auto &edges) {
        const auto &[u, v] = edges;
        const auto opposite = difference(v, u);
        return dot(u, v).sign() > 0 && dot(u, opposite).sign() < 0 && dot(v, opposite).sign() > 0;
    });
}

bool dihedral_angles_acute(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) {
    return decided<4>({a, b, c, d}, [](const auto &edges) {
        const auto &[u, v, w] = edges;
        const std::array n = {cross(v, w), cross(w, u), cross(u, v)};
        const auto others = sum(sum(n[0], n[1]), n[2]); // less the fourth normal
        for (int i = 0; i < 3; ++i)
            if (dot(n[i], n[(i + 1) % 3]).sign() >= 0 || dot(n[i], others).sign() <= 0)
                return false;
        return true;
    });
}

} // namespace wct::geometry
