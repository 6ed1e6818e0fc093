#include "predicates.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace wct {

namespace {

/// A whole number of any size, as much of one as a determinant needs.
class Integer {
  public:
    Integer() = default;

    /// value * 2^-exponent, which must be whole.
    Integer(double value, int exponent) : negative_(value < 0.0) {
        if (value == 0.0)
            return;
        int power = 0;
        const double fraction = std::frexp(std::fabs(value), &power);
        auto mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
        int shift = power - 53 - exponent;
        for (; shift < 0; ++shift)
            mantissa >>= 1; // trailing zeros only: the number is whole
        digits_.assign(static_cast<std::size_t>(shift / 32), 0);
        const int rest = shift % 32;
        const std::uint64_t low = mantissa << rest;
        const std::uint64_t high = rest ? mantissa >> (64 - rest) : 0;
        for (const std::uint64_t part : {low, low >> 32, high})
            digits_.push_back(static_cast<std::uint32_t>(part));
        trim();
    }

    int sign() const { return digits_.empty() ? 0 : negative_ ? -1 : 1; }

    friend Integer operator-(const Integer &x) {
        Integer out = x;
        out.negative_ = !x.negative_;
        return out;
    }

    friend Integer operator+(const Integer &x, const Integer &y) {
        if (x.negative_ == y.negative_)
            return Integer(x.negative_, sum(x.digits_, y.digits_));
        return less(x.digits_, y.digits_) ? Integer(y.negative_, difference(y.digits_, x.digits_))
                                          : Integer(x.negative_, difference(x.digits_, y.digits_));
    }

    friend Integer operator-(const Integer &x, const Integer &y) { return x + -y; }

    friend Integer operator*(const Integer &x, const Integer &y) {
        Digits out(x.digits_.size() + y.digits_.size(), 0);
        for (std::size_t i = 0; i < x.digits_.size(); ++i) {
            std::uint64_t carry = 0;
            for (std::size_t j = 0; j < y.digits_.size(); ++j) {
                carry += std::uint64_t{x.digits_[i]} * y.digits_[j] + out[i + j];
                out[i + j] = static_cast<std::uint32_t>(carry);
                carry >>= 32;
            }
            out[i + y.digits_.size()] = static_cast<std::uint32_t>(carry);
        }
        return Integer(x.negative_ != y.negative_, std::move(out));
    }

  private:
    using Digits = std::vector<std::uint32_t>; // base 2^32, lowest first, no leading zero

    Integer(bool negative, Digits digits) : negative_(negative), digits_(std::move(digits)) { trim(); }

    void trim() {
        while (!digits_.empty() && digits_.back() == 0)
            digits_.pop_back();
    }

    static bool less(const Digits &x, const Digits &y) {
        if (x.size() != y.size())
            return x.size() < y.size();
        return std::lexicographical_compare(x.rbegin(), x.rend(), y.rbegin(), y.rend());
    }

    static Digits sum(const Digits &x, const Digits &y) {
        Digits out;
        std::uint64_t carry = 0;
        for (std::size_t i = 0; i < std::max(x.size(), y.size()) || carry; ++i) {
            carry += (i < x.size() ? x[i] : 0ull) + (i < y.size() ? y[i] : 0ull);
            out.push_back(static_cast<std::uint32_t>(carry));
            carry >>= 32;
        }
        return out;
    }

    /// x - y for x >= y.
    static Digits difference(const Digits &x, const Digits &y) {
        Digits out;
        std::int64_t carry = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            carry += std::int64_t{x[i]} - (i < y.size() ? std::int64_t{y[i]} : 0);
            out.push_back(static_cast<std::uint32_t>(carry));
            carry >>= 32; // arithmetic: -1 where a digit was borrowed
        }
        return out;
    }

    bool negative_ = false;
    Digits digits_;
};

struct Integer3 {
    Integer x;
    Integer y;
    Integer z;
};

Integer3 operator+(const Integer3 &a, const Integer3 &b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Integer3 operator-(const Integer3 &a, const Integer3 &b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Integer3 operator*(const Integer &s, const Integer3 &a) {
    return {s * a.x, s * a.y, s * a.z};
}
Integer dot(const Integer3 &a, const Integer3 &b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Integer3 cross(const Integer3 &a, const Integer3 &b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The points as whole multiples of a common power of two, which changes no sign.
template <std::size_t count> std::array<Integer3, count> whole(const std::array<Vec3, count> &points) {
    int exponent = 0;
    bool any = false;
    for (const Vec3 &point : points)
        for (const double value : {point.x, point.y, point.z})
            if (value != 0.0) {
                int power = 0;
                std::frexp(value, &power);
                exponent = any ? std::min(exponent, power - 53) : power - 53;
                any = true;
            }
    std::array<Integer3, count> out;
    for (std::size_t i = 0; i < count; ++i)
        out[i] = {Integer(points[i].x, exponent), Integer(points[i].y, exponent), Integer(points[i].z, exponent)};
    return out;
}

int orient3d_exact(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) {
    const auto x = whole<4>({a, b, c, d});
    return dot(x[1] - x[0], cross(x[2] - x[0], x[3] - x[0])).sign();
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
    // and what underflow may lose: in the last products, and in the inner ones, which the edge u then magnifies. An
    // overflow leaves infinity or NaN, which fails the test.
    constexpr double unit = 0x1p-53;
    constexpr double bound = (7.0 + 56.0 * unit) * unit;
    const double lost = 1e-300 + 1e-300 * (std::fabs(u.x) + std::fabs(u.y) + std::fabs(u.z));
    if (std::fabs(det) > bound * size + lost && std::isfinite(size))
        return det > 0.0 ? 1 : -1;
    return orient3d_exact(a, b, c, d);
}

bool contains_circumcenter(const Vec3 &a, const Vec3 &b, const Vec3 &c, const Vec3 &d) {
    const auto x = whole<4>({a, b, c, d});
    const Integer3 u = x[1] - x[0];
    const Integer3 v = x[2] - x[0];
    const Integer3 w = x[3] - x[0];
    const Integer3 n1 = cross(v, w);
    const Integer3 n2 = cross(w, u);
    const Integer3 n3 = cross(u, v);
    // 2 det times the circumcenter, seen from the first corner; the heights over the facets have the signs below.
    const Integer3 center = dot(u, u) * n1 + dot(v, v) * n2 + dot(w, w) * n3;
    const Integer det = dot(u, n1);
    return dot(n1, center).sign() > 0 && dot(n2, center).sign() > 0 && dot(n3, center).sign() > 0 &&
           dot(n1 + n2 + n3, center - (det + det) * u).sign() < 0;
}

bool acute(const Vec3 &a, const Vec3 &b, const Vec3 &c) {
    const auto x = whole<3>({a, b, c});
    return dot(x[1] - x[0], x[2] - x[0]).sign() > 0 && dot(x[2] - x[1], x[0] - x[1]).sign() > 0 &&
           dot(x[0] - x[2], x[1] - x[2]).sign() > 0;
}

} // namespace wct
