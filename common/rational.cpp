// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/rational.hpp"

#include <charconv>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace gridspace {
namespace {

__extension__ using Wide = __int128; // products of two 64-bit numbers

Wide wide_gcd(Wide a, Wide b) {
    while (b != 0) {
        Wide const r = a % b;
        a = b;
        b = r;
    }
    return a < 0 ? -a : a;
}

Rational reduce(Wide num, Wide den) {
    if (den == 0) {
        throw std::domain_error{"fraction with a zero denominator"};
    }
    Wide const g = wide_gcd(num, den);
    if (g != 0) {
        num /= g;
        den /= g;
    }
    if (den < 0) {
        num = -num;
        den = -den;
    }
    constexpr Wide kMax = std::numeric_limits<std::int64_t>::max();
    if (num > kMax || num < -kMax || den > kMax) {
        throw std::overflow_error{"fraction does not fit into 64 bits"};
    }
    return {static_cast<std::int64_t>(num), static_cast<std::int64_t>(den)};
}

constexpr Wide kWidestMantissa = static_cast<Wide>(1) << 100; ///< with another digit it still fits

struct Mantissa {
    Wide digits;
    int scale;         ///< power of ten
    std::size_t taken; ///< characters
};

/// Digits with an optional point.
std::optional<Mantissa> parse_mantissa(std::string_view text) {
    Mantissa out{0, 0, 0};
    bool point = false;
    bool any = false;
    for (; out.taken < text.size(); ++out.taken) {
        char const c = text[out.taken];
        if (c == '.' && !point) {
            point = true;
        } else if (c >= '0' && c <= '9') {
            if (out.digits > kWidestMantissa) {
                return std::nullopt;
            }
            out.digits = out.digits * 10 + (c - '0');
            out.scale -= point ? 1 : 0;
            any = true;
        } else {
            break;
        }
    }
    return any ? std::optional{out} : std::nullopt;
}

/// "e-3"; 0 for nothing.
std::optional<int> parse_exponent(std::string_view text) {
    if (text.empty()) {
        return 0;
    }
    if (text.front() != 'e' && text.front() != 'E') {
        return std::nullopt;
    }
    std::string_view digits = text.substr(1);
    if (!digits.empty() && digits.front() == '+') {
        digits.remove_prefix(1);
    }
    int exponent = 0;
    auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
    if (error != std::errc{} || end != digits.data() + digits.size() || exponent > 30 || exponent < -30) {
        return std::nullopt;
    }
    return exponent;
}

/// `value` times ten to the power of `exponent`.
std::optional<Wide> times_power_of_ten(Wide value, int exponent) {
    for (; exponent > 0; --exponent) {
        if (value > kWidestMantissa) {
            return std::nullopt;
        }
        value *= 10;
    }
    return value;
}

/// A decimal number as an exact fraction: digits, optional point, optional exponent.
std::optional<Rational> parse_decimal(std::string_view text) {
    bool negative = false;
    if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
        negative = text.front() == '-';
        text.remove_prefix(1);
    }
    auto const mantissa = parse_mantissa(text);
    if (!mantissa) {
        return std::nullopt;
    }
    auto const exponent = parse_exponent(text.substr(mantissa->taken));
    if (!exponent) {
        return std::nullopt;
    }
    Wide digits = mantissa->digits;
    int scale = mantissa->scale + *exponent;
    while (scale < 0 && digits % 10 == 0 && digits != 0) {
        digits /= 10;
        ++scale;
    }
    if (digits == 0) {
        return Rational{0};
    }
    auto const num = times_power_of_ten(digits, scale);
    auto const den = times_power_of_ten(1, -scale);
    if (!num || !den) {
        return std::nullopt;
    }
    try {
        return reduce(negative ? -*num : *num, *den);
    } catch (std::overflow_error const&) {
        return std::nullopt;
    }
}

} // namespace

Rational::Rational(std::int64_t num, std::int64_t den) : num_{num}, den_{den} {
    if (den == 0) {
        throw std::domain_error{"fraction with a zero denominator"};
    }
    std::int64_t const g = std::gcd(num, den);
    num_ = num / g;
    den_ = den / g;
    if (den_ < 0) {
        num_ = -num_;
        den_ = -den_;
    }
}

std::string Rational::to_string() const {
    return den_ == 1 ? std::to_string(num_) : std::to_string(num_) + "/" + std::to_string(den_);
}

std::optional<Rational> Rational::parse(std::string_view text) {
    std::size_t const slash = text.find('/');
    if (slash == std::string_view::npos) {
        return parse_decimal(text);
    }
    auto const trim = [](std::string_view s) {
        while (!s.empty() && s.front() == ' ') {
            s.remove_prefix(1);
        }
        while (!s.empty() && s.back() == ' ') {
            s.remove_suffix(1);
        }
        return s;
    };
    auto const num = parse_decimal(trim(text.substr(0, slash)));
    auto const den = parse_decimal(trim(text.substr(slash + 1)));
    if (!num || !den || den->num() == 0) {
        return std::nullopt;
    }
    try {
        return *num / *den;
    } catch (std::overflow_error const&) {
        return std::nullopt;
    }
}

Rational operator+(Rational a, Rational b) {
    return reduce(static_cast<Wide>(a.num_) * b.den_ + static_cast<Wide>(b.num_) * a.den_,
                  static_cast<Wide>(a.den_) * b.den_);
}
Rational operator-(Rational a, Rational b) {
    return reduce(static_cast<Wide>(a.num_) * b.den_ - static_cast<Wide>(b.num_) * a.den_,
                  static_cast<Wide>(a.den_) * b.den_);
}
Rational operator*(Rational a, Rational b) {
    return reduce(static_cast<Wide>(a.num_) * b.num_, static_cast<Wide>(a.den_) * b.den_);
}
Rational operator/(Rational a, Rational b) {
    return reduce(static_cast<Wide>(a.num_) * b.den_, static_cast<Wide>(a.den_) * b.num_);
}
std::strong_ordering operator<=>(Rational a, Rational b) {
    return static_cast<Wide>(a.num_) * b.den_ <=> static_cast<Wide>(b.num_) * a.den_;
}

std::int64_t Rational::floor() const {
    std::int64_t const q = num_ / den_;
    return (num_ % den_ != 0 && num_ < 0) ? q - 1 : q;
}
std::int64_t Rational::ceil() const {
    std::int64_t const q = num_ / den_;
    return (num_ % den_ != 0 && num_ > 0) ? q + 1 : q;
}
std::int64_t Rational::round() const {
    std::int64_t const q = num_ / den_;
    Wide const r = num_ % den_;
    Wide const twice = r < 0 ? -2 * r : 2 * r;
    if (twice < den_) {
        return q;
    }
    return num_ < 0 ? q - 1 : q + 1;
}

Rational common_divisor(Rational a, Rational b) {
    // gcd(p/q, r/s) = gcd(p s, r q) / (q s)
    Wide const ps = static_cast<Wide>(a.num()) * b.den();
    Wide const rq = static_cast<Wide>(b.num()) * a.den();
    return reduce(wide_gcd(ps, rq), static_cast<Wide>(a.den()) * b.den());
}

} // namespace gridspace
