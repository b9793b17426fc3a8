// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/mapping/constant.hpp"

#include "common/text.hpp"
#include "gateways/iec61850/quality.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::mapping {
namespace {

namespace quality = iec61850::quality;

constexpr std::array<std::pair<std::string_view, std::uint32_t>, 14> kQualities{
    {{"good", quality::kGood},
     {"invalid", quality::kInvalid},
     {"questionable", quality::kQuestionable},
     {"overflow", quality::kOverflow},
     {"out_of_range", quality::kOutOfRange},
     {"bad_reference", quality::kBadReference},
     {"oscillatory", quality::kOscillatory},
     {"failure", quality::kFailure},
     {"old_data", quality::kOldData},
     {"inconsistent", quality::kInconsistent},
     {"inaccurate", quality::kInaccurate},
     {"substituted", quality::kSubstituted},
     {"test", quality::kTest},
     {"operator_blocked", quality::kOperatorBlocked}}};
constexpr std::string_view kDerived = "derived"; ///< of sampled values only
constexpr std::array<std::string_view, 4> kPositions{"intermediate", "open", "closed", "bad"};

/// A whole number, decimal or 0x..., as sign and magnitude.
struct Whole {
    bool negative{false};
    std::uint64_t magnitude{0};
};
std::optional<Whole> parse_whole(std::string_view text) {
    Whole out;
    if (text.starts_with('-') || text.starts_with('+')) {
        out.negative = text.front() == '-';
        text.remove_prefix(1);
    }
    int const base = text.starts_with("0x") || text.starts_with("0X") ? 16 : 10;
    text.remove_prefix(base == 16 ? 2 : 0);
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), out.magnitude, base);
    return !text.empty() && error == std::errc{} && end == text.data() + text.size() ? std::optional{out}
                                                                                     : std::nullopt;
}

std::optional<Value> parse_integer(std::string_view text, BasicType type) {
    auto const whole = parse_whole(text);
    if (!whole) {
        return std::nullopt;
    }
    std::uint64_t const high =
        ~std::uint64_t{0} >> (64 - 8 * iec61850::integer_octets(type) + (iec61850::is_signed(type) ? 1 : 0));
    std::uint64_t const low = iec61850::is_signed(type) ? high + 1 : 0; // magnitude of the lowest
    if (whole->magnitude > (whole->negative ? low : high)) {
        return std::nullopt;
    }
    return Value{type, 0, whole->negative ? ~whole->magnitude + 1 : whole->magnitude, {}};
}

std::uint32_t highest_quality(Field const& field) {
    return (1U << quality_bits(field)) - 1;
}

std::optional<Value> parse_quality(std::string_view text, std::uint32_t highest) {
    if (auto const whole = parse_whole(text)) {
        return !whole->negative && whole->magnitude <= highest
                   ? std::optional{Value::quality(static_cast<std::uint32_t>(whole->magnitude))}
                   : std::nullopt;
    }
    std::uint32_t bits = 0;
    while (true) {
        std::size_t const bar = std::min(text.find('|'), text.size());
        std::string_view word = text.substr(0, bar);
        word.remove_prefix(std::min(word.find_first_not_of(' '), word.size()));
        word = word.substr(0, word.find_last_not_of(' ') + 1);
        auto const known =
            std::find_if(kQualities.begin(), kQualities.end(), [&](auto const& q) { return q.first == word; });
        bool const derived = word == kDerived && (highest & quality::kDerived) != 0;
        if (known == kQualities.end() && !derived) {
            return std::nullopt;
        }
        bits |= derived ? quality::kDerived : known->second;
        if (bar == text.size()) {
            return Value::quality(bits);
        }
        text.remove_prefix(bar + 1);
    }
}

} // namespace

std::optional<Value> parse_constant(std::string_view text, Field const& field, Enumerators enumerators) {
    switch (field.type) {
    case BasicType::boolean:
        return text == "true"    ? std::optional{Value::of(true)}
               : text == "false" ? std::optional{Value::of(false)}
                                 : std::nullopt;
    case BasicType::position:
        for (std::size_t i = 0; i < kPositions.size(); ++i) {
            if (text == kPositions[i]) {
                return Value{BasicType::position, 0, i, {}};
            }
        }
        return std::nullopt;
    case BasicType::quality:
        return parse_quality(text, highest_quality(field));
    case BasicType::enumerated:
        for (auto const& [name, number] : enumerators) {
            if (text == name) {
                return Value::integer(BasicType::enumerated, number);
            }
        }
        return enumerators.empty() ? parse_integer(text, field.type) : std::nullopt;
    case BasicType::float32:
    case BasicType::float64: {
        double v = 0;
        auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
        bool const whole = error == std::errc{} && end == text.data() + text.size() && std::isfinite(v);
        return whole ? std::optional{Value::from_number(field.type, v)} : std::nullopt;
    }
    case BasicType::visible_string:
        return text.size() <= field.length ? std::optional{Value::visible(text)} : std::nullopt;
    default:
        return iec61850::is_integer(field.type) ? parse_integer(text, field.type) : std::nullopt;
    }
}

std::string expected_constant(Field const& field, Enumerators enumerators) {
    switch (field.type) {
    case BasicType::boolean:
        return "expected true or false";
    case BasicType::position:
        return "expected open, closed, intermediate or bad";
    case BasicType::quality: {
        std::vector<std::string> words;
        for (auto const& [word, bits] : kQualities) {
            words.emplace_back(word);
        }
        bool const sampled = (highest_quality(field) & quality::kDerived) != 0;
        if (sampled) {
            words.emplace_back(kDerived);
        }
        return fmt::format("expected {}, joined by '|', or a number up to 0x{:x}{}", join(words, ", "),
                           highest_quality(field), sampled ? "" : ": GOOSE has no bit for 'derived'");
    }
    case BasicType::visible_string:
        return fmt::format("expected a text of at most {} characters", field.length);
    case BasicType::enumerated: {
        std::vector<std::string> names;
        for (auto const& [name, number] : enumerators) {
            names.push_back(name);
        }
        return names.empty() ? "expected a whole number" : "expected one of " + join(names, ", ");
    }
    default:
        return iec61850::is_number(field.type)
                   ? fmt::format("expected a number that fits into {}", type_name(field.type))
                   : fmt::format("a constant of type {} cannot be written", type_name(field.type));
    }
}

} // namespace gridspace::mapping
