// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace gridspace {

/// An exact fraction, always reduced, with a positive denominator: 1/48000 s is not a decimal number.
/// Operations that leave 64 bits throw std::overflow_error.
class Rational {
  public:
    constexpr Rational() = default;
    constexpr Rational(std::int64_t whole)
        : num_{whole} {}                          // NOLINT(google-explicit-constructor): a whole is a fraction
    Rational(std::int64_t num, std::int64_t den); ///< throws std::domain_error when den is 0

    [[nodiscard]] constexpr std::int64_t num() const { return num_; }
    [[nodiscard]] constexpr std::int64_t den() const { return den_; }
    [[nodiscard]] double to_double() const { return static_cast<double>(num_) / static_cast<double>(den_); }
    [[nodiscard]] std::string to_string() const; ///< "1/48000", or "3" for a whole

    /// Reads "3", "-0.25", "1.5e-3", "1/48000" and "0.5/3" exactly; nothing for any other text or out of range.
    [[nodiscard]] static std::optional<Rational> parse(std::string_view text);

    friend Rational operator+(Rational a, Rational b);
    friend Rational operator-(Rational a, Rational b);
    friend Rational operator*(Rational a, Rational b);
    friend Rational operator/(Rational a, Rational b); ///< throws std::domain_error when b is 0
    friend bool operator==(Rational a, Rational b) = default;
    friend std::strong_ordering operator<=>(Rational a, Rational b);

    [[nodiscard]] std::int64_t floor() const;
    [[nodiscard]] std::int64_t ceil() const;
    [[nodiscard]] std::int64_t round() const; ///< half away from zero
    [[nodiscard]] bool is_whole() const { return den_ == 1; }

  private:
    std::int64_t num_{0};
    std::int64_t den_{1};
};

/// The largest fraction of which both are whole multiples (both positive).
[[nodiscard]] Rational common_divisor(Rational a, Rational b);

} // namespace gridspace
