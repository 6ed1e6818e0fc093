#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace wct::tests {

/// A whole number of any size, the slow and plain way: sign and digits to the base 2^32, lowest first.
class BigInteger {
  public:
    BigInteger(long long value = 0) : negative_(value < 0) {
        for (unsigned long long left = value < 0 ? 0ull - static_cast<unsigned long long>(value)
                                                 : static_cast<unsigned long long>(value);
             left; left >>= 32)
            digits_.push_back(static_cast<std::uint32_t>(left));
    }

    /// value / 2^exponent, which must be whole.
    static BigInteger scaled(double value, int exponent) {
        int power = 0;
        const double mantissa = std::frexp(value, &power); // value = mantissa 2^power
        BigInteger out(static_cast<long long>(std::ldexp(mantissa, 53)));
        int shift = power - 53 - exponent;
        for (; shift < 0; ++shift) // the lowest bits are zero
            out = out.halved();
        for (; shift >= 32; shift -= 32)
            if (!out.digits_.empty())
                out.digits_.insert(out.digits_.begin(), 0u);
        return out * BigInteger(1ll << shift);
    }

    int sign() const { return digits_.empty() ? 0 : negative_ ? -1 : 1; }

    friend BigInteger operator-(BigInteger x) {
        x.negative_ = !x.negative_;
        return x;
    }
    friend BigInteger operator+(const BigInteger &x, const BigInteger &y) {
        if (x.negative_ == y.negative_)
            return with(x.negative_, sum(x.digits_, y.digits_));
        return less(x.digits_, y.digits_) ? with(y.negative_, difference(y.digits_, x.digits_))
                                          : with(x.negative_, difference(x.digits_, y.digits_));
    }
    friend BigInteger operator-(const BigInteger &x, const BigInteger &y) { return x + -y; }
    friend BigInteger operator*(const BigInteger &x, const BigInteger &y) {
        Digits out(x.digits_.size() + y.digits_.size(), 0);
        for (std::size_t i = 0; i < x.digits_.size(); ++i) {
            std::uint64_t carry = 0;
            for (std::size_t j = 0; j < y.digits_.size() || carry; ++j) {
                carry += out[i + j];
                if (j < y.digits_.size())
                    carry += std::uint64_t{x.digits_[i]} * y.digits_[j];
                out[i + j] = static_cast<std::uint32_t>(carry);
                carry >>= 32;
            }
        }
        return with(x.negative_ != y.negative_, std::move(out));
    }

  private:
    using Digits = std::vector<std::uint32_t>;

    static BigInteger with(bool negative, Digits digits) {
        while (!digits.empty() && digits.back() == 0)
            digits.pop_back();
        BigInteger out;
        out.negative_ = negative;
        out.digits_ = std::move(digits);
        return out;
    }
    static bool less(const Digits &x, const Digits &y) {
        if (x.size() != y.size())
            return x.size() < y.size();
        for (std::size_t i = x.size(); i-- > 0;)
            if (x[i] != y[i])
                return x[i] < y[i];
        return false;
    }
    static Digits sum(const Digits &x, const Digits &y) {
        Digits out;
        std::uint64_t carry = 0;
        for (std::size_t i = 0; i < x.size() || i < y.size() || carry; ++i) {
            carry += (i < x.size() ? x[i] : 0ull) + (i < y.size() ? y[i] : 0ull);
            out.push_back(static_cast<std::uint32_t>(carry));
            carry >>= 32;
        }
        return out;
    }
    static Digits difference(const Digits &x, const Digits &y) { // x >= y
        Digits out;
        std::int64_t borrow = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            std::int64_t digit = std::int64_t{x[i]} - (i < y.size() ? std::int64_t{y[i]} : 0) - borrow;
            borrow = digit < 0;
            if (borrow)
                digit += std::int64_t{1} << 32;
            out.push_back(static_cast<std::uint32_t>(digit));
        }
        return out;
    }
    BigInteger halved() const {
        Digits out(digits_.size());
        for (std::size_t i = 0; i < digits_.size(); ++i)
            out[i] = digits_[i] >> 1 | (i + 1 < digits_.size() ? digits_[i + 1] << 31 : 0u);
        return with(negative_, std::move(out));
    }

    bool negative_ = false;
    Digits digits_;
};

} // namespace wct::tests
