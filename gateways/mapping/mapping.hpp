// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/data_set.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gridspace::mapping {

using iec61850::BasicType;
using iec61850::Value;

/// A basic value on either side: a member of a stream's data set, or of a DDS type (its IDL types have the same names
/// here; an enumeration is `enumerated`, a time in nanoseconds int64).
struct Field {
    std::string name{}; ///< "Ia", "pos.q", "samples.ia"
    BasicType type{BasicType::boolean};
    std::uint16_t length{0}; ///< of strings the most octets, of bit strings and qualities the bits
    std::string unit{};      ///< "A", "mA", "kV"; empty: not known
};
[[nodiscard]] std::vector<Field> fields_of(iec61850::DataSet const& data_set);
/// 14 in sampled values, with "derived" of 9-2LE; 13 where the length says so.
[[nodiscard]] unsigned quality_bits(Field const& field) noexcept;

/// `to` becomes from * scale + offset, after the units of both have been converted.
struct Rule {
    std::string from, to;
    double scale{1}, offset{0};
    std::string from_unit, to_unit; ///< override those of the fields
    std::optional<Value> constant;  ///< instead of `from`
    bool invert{false};             ///< of booleans, and of true_is_open
    bool true_is_open{true};        ///< boolean <-> position: what true means
};

/// What is wrong with a rule: its place in the list, and a sentence.
struct Mistake {
    std::size_t rule{0};
    std::string message, hint;
    bool about_to{false}; ///< the mistake is in `to`, not in `from`
};

struct Counters {
    std::uint64_t applied{0};
    std::uint64_t saturated{0};  ///< values beyond the range of the type that they became; numbers that are no quality
    std::uint64_t not_finite{0}; ///< NaN or infinity that became an integer
};

/// A table of rules, checked once against both sides, then applied without allocation.
class Mapping {
  public:
    /// Reports every mistake: unknown fields (with the nearest spelling), types that do not convert, units of other
    /// quantities, targets written twice. Fields of `to` that no rule writes keep their value: `unmapped()`.
    [[nodiscard]] static Mapping compile(std::vector<Rule> const& rules, std::vector<Field> const& from,
                                         std::vector<Field> const& to, std::vector<Mistake>& mistakes);

    /// `in` and `out` hold a value per field, in the order of the lists given to compile(). Texts of `out` point into
    /// `in`.
    void apply(std::span<Value const> in, std::span<Value> out) noexcept;

    [[nodiscard]] Counters const& counters() const noexcept { return counters_; }
    [[nodiscard]] std::vector<std::string> const& unmapped() const noexcept { return unmapped_; }

  private:
    enum class Kind : std::uint8_t {
        copy,    ///< same kind of value, no arithmetic
        number,  ///< scale and offset through double
        integer, ///< integer to integer without arithmetic: exact in 64 bits
        bits,    ///< a quality and what holds its bits: never a quantity
        boolean_to_position,
        position_to_boolean,
        code_to_position, ///< Dbpos by its number, as in an IDL enumeration or an integer
        time_to_nanoseconds,
        nanoseconds_to_time,
        constant,
    };
    struct Step {
        Kind kind{Kind::copy};
        std::size_t from{0}, to{0};
        BasicType to_type{BasicType::boolean};
        double scale{1}, offset{0};
        std::uint64_t mask{0}; ///< of Kind::bits: those that the target has
        bool invert{false};
        Value constant;
    };
    static std::optional<Step> step_of(Rule const& rule, Field const& from, Field const& to, Mistake& mistake);
    /// What is no arithmetic. Why it cannot be, as a hint.
    static std::optional<std::string> choose_kind(Step& step, Rule const& rule, Field const& from, Field const& to);
    [[nodiscard]] Value convert(Step const& step, Value const& in) noexcept;
    [[nodiscard]] Value to_integer(Step const& step, Value const& in) noexcept;
    [[nodiscard]] Value to_bits(Step const& step, Value const& in) noexcept;
    [[nodiscard]] Value to_number(Step const& step, Value const& in) noexcept;

    std::vector<Step> steps_;
    std::vector<std::string> unmapped_;
    Counters counters_;
};

/// The factor from one unit to another of the same quantity ("kA" to "mA": 1e6); nothing when they measure different
/// things or are not known.
[[nodiscard]] std::optional<double> unit_factor(std::string_view from, std::string_view to);
[[nodiscard]] bool is_unit(std::string_view unit);

} // namespace gridspace::mapping
