// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/mapping/mapping.hpp"

#include "common/text.hpp"
#include "gateways/iec61850/quality.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::mapping {
namespace {

using namespace iec61850;

std::optional<std::size_t> index_of(std::vector<Field> const& fields, std::string_view name) {
    auto const found = std::find_if(fields.begin(), fields.end(), [&](Field const& f) { return f.name == name; });
    return found == fields.end() ? std::nullopt : std::optional{static_cast<std::size_t>(found - fields.begin())};
}

std::string near(std::vector<Field> const& fields, std::string_view name) {
    std::vector<std::string> names;
    for (Field const& field : fields) {
        names.push_back(field.name);
    }
    return spelling_hint(name, names);
}

/// Numbers that arithmetic may be done with; a quality or a bit string is not one.
bool arithmetic(BasicType type) {
    return is_number(type);
}

/// How many bits a field holds, where it holds bits and not a quantity; 0 where it does not.
unsigned bits_of(Field const& field) {
    switch (field.type) {
    case BasicType::quality:
        return quality_bits(field);
    case BasicType::bit_string:
        return field.length == 0 ? 64 : std::min<unsigned>(field.length, 64);
    default:
        return is_unsigned(field.type) ? static_cast<unsigned>(8 * integer_octets(field.type)) : 0;
    }
}

/// The largest value of an integer type, as bits; signed ones reach from -high - 1.
std::uint64_t highest(BasicType type) noexcept {
    return ~std::uint64_t{0} >> (64 - 8 * integer_octets(type) + (is_signed(type) ? 1 : 0));
}

/// What a value is multiplied with to be in the unit of the target; nothing when that is not known.
std::optional<double> factor_of_units(Rule const& rule, Field const& from, Field const& to, Mistake& mistake) {
    std::string const& from_unit = rule.from_unit.empty() ? from.unit : rule.from_unit;
    std::string const& to_unit = rule.to_unit.empty() ? to.unit : rule.to_unit;
    for (std::string const* unit : {&from_unit, &to_unit}) {
        if (!unit->empty() && !is_unit(*unit)) {
            mistake.message = fmt::format("'{}' is not a unit", *unit);
            mistake.hint = "A, V, W, VA, var, Hz, s, ohm, Wh, varh, degC, deg, pu, %, with n u m k M G before it";
            return std::nullopt;
        }
    }
    if (!from_unit.empty() && !to_unit.empty()) {
        auto const factor = unit_factor(from_unit, to_unit);
        if (!factor) {
            mistake.message = fmt::format("'{}' is in {}, '{}' in {}: they measure different things", from.name,
                                          from_unit, to.name, to_unit);
        }
        return factor;
    }
    if (from_unit.empty() != to_unit.empty() && !(rule.from_unit.empty() && rule.to_unit.empty())) {
        bool const from_known = !from_unit.empty();
        mistake.message =
            fmt::format("'{}' is in {}, and the unit of '{}' is not known", from_known ? from.name : to.name,
                        from_known ? from_unit : to_unit, from_known ? to.name : from.name);
        mistake.about_to = from_known;
        mistake.hint = fmt::format("say it with {}, or scale without units", from_known ? "to_unit" : "from_unit");
        return std::nullopt;
    }
    return 1;
}

} // namespace

unsigned quality_bits(Field const& field) noexcept {
    return field.length == 0 ? quality::kSampledBits : field.length;
}

std::vector<Field> fields_of(DataSet const& data_set) {
    std::vector<Field> out;
    for (Leaf& leaf : leaves_of(data_set)) {
        out.push_back({std::move(leaf.name), leaf.type, leaf.length, {}});
    }
    return out;
}

std::optional<Mapping::Step> Mapping::step_of(Rule const& rule, Field const& from, Field const& to, Mistake& mistake) {
    auto const factor = factor_of_units(rule, from, to, mistake);
    if (!factor) {
        return std::nullopt;
    }
    Step step;
    step.to_type = to.type;
    step.scale = rule.scale * *factor;
    step.offset = rule.offset;
    step.invert = rule.invert;
    bool const scaled = step.scale != 1 || step.offset != 0;
    if (arithmetic(from.type) && arithmetic(to.type)) {
        bool const exact = is_integer(from.type) && is_integer(to.type) && !scaled;
        step.kind = from.type == to.type && !scaled ? Kind::copy : exact ? Kind::integer : Kind::number;
        return step;
    }
    if (from.type == BasicType::boolean && arithmetic(to.type)) {
        step.kind = Kind::number; // 0 or 1
        return step;
    }
    if (auto const refused = choose_kind(step, rule, from, to)) {
        mistake.message = fmt::format("'{}' is {}, '{}' is {}: one does not become the other", from.name,
                                      type_name(from.type), to.name, type_name(to.type));
        mistake.hint = *refused;
        return std::nullopt;
    }
    if (scaled) {
        mistake.message = fmt::format("'{}' is {}: it has no scale, offset or unit", from.name, type_name(from.type));
        return std::nullopt;
    }
    return step;
}

std::optional<std::string> Mapping::choose_kind(Step& step, Rule const& rule, Field const& from, Field const& to) {
    if (from.type == BasicType::timestamp && to.type == BasicType::int64) {
        step.kind = Kind::time_to_nanoseconds;
    } else if (from.type == BasicType::int64 && to.type == BasicType::timestamp) {
        step.kind = Kind::nanoseconds_to_time;
    } else if (from.type == BasicType::boolean && to.type == BasicType::position) {
        step.kind = Kind::boolean_to_position;
        step.invert = rule.invert != !rule.true_is_open;
    } else if (from.type == BasicType::position && to.type == BasicType::boolean) {
        step.kind = Kind::position_to_boolean;
        step.invert = rule.invert != !rule.true_is_open;
    } else if (is_integer(from.type) && to.type == BasicType::position) {
        step.kind = Kind::code_to_position;
    } else if (from.type == BasicType::position && is_integer(to.type)) {
        step.kind = Kind::integer;
    } else if (is_string(from.type) && is_string(to.type)) {
        if (from.length > to.length) {
            return fmt::format("{} characters do not fit into {}", from.length, to.length);
        }
    } else if (from.type == BasicType::quality || to.type == BasicType::quality) {
        unsigned const bits = bits_of(to);
        bool const room = to.type == BasicType::quality || bits >= std::min(quality_bits(from), quality::kBits);
        if (bits_of(from) == 0 || !room) {
            return is_number(from.type) || is_number(to.type)
                       ? "a quality is a set of bits: its number is uint16, uint32 or uint64"
                       : "";
        }
        step.kind = Kind::bits;
        step.mask = ~std::uint64_t{0} >> (64 - bits);
    } else if (from.type == to.type) {
        step.kind = Kind::copy;
    } else if (arithmetic(from.type) && to.type == BasicType::boolean) {
        return "what is true is a decision: make it where the number is made";
    } else {
        bool const position = is_number(from.type) && to.type == BasicType::position;
        return position
                   ? "a position is a boolean, an enumeration or a whole number: 0 intermediate, 1 open, 2 closed, "
                     "3 bad"
                   : "";
    }
    return std::nullopt;
}

Mapping Mapping::compile(std::vector<Rule> const& rules, std::vector<Field> const& from, std::vector<Field> const& to,
                         std::vector<Mistake>& mistakes) {
    Mapping out;
    std::vector<bool> written(to.size());
    for (std::size_t i = 0; i < rules.size(); ++i) {
        Rule const& rule = rules[i];
        Mistake mistake{i, {}, {}, false};
        auto const target = index_of(to, rule.to);
        if (!target) {
            mistakes.push_back({i, fmt::format("there is no field '{}' to write", rule.to), near(to, rule.to), true});
            continue;
        }
        if (written[*target]) {
            mistakes.push_back({i, fmt::format("field '{}' is written twice", rule.to), {}, true});
            continue;
        }
        written[*target] = true;
        if (rule.constant) {
            if (rule.constant->type != to[*target].type) {
                mistakes.push_back({i,
                                    fmt::format("the constant for '{}' is {}, the field {}", rule.to,
                                                type_name(rule.constant->type), type_name(to[*target].type)),
                                    {},
                                    true});
                continue;
            }
            Step step;
            step.kind = Kind::constant;
            step.to = *target;
            step.constant = *rule.constant;
            out.steps_.push_back(step);
            continue;
        }
        auto const source = index_of(from, rule.from);
        if (!source) {
            mistakes.push_back(
                {i, fmt::format("there is no field '{}' to read", rule.from), near(from, rule.from), false});
            continue;
        }
        if (auto step = step_of(rule, from[*source], to[*target], mistake)) {
            step->from = *source;
            step->to = *target;
            out.steps_.push_back(*step);
        } else {
            mistakes.push_back(std::move(mistake));
        }
    }
    for (std::size_t i = 0; i < to.size(); ++i) {
        if (!written[i]) {
            out.unmapped_.push_back(to[i].name);
        }
    }
    return out;
}

Value Mapping::to_number(Step const& step, Value const& in) noexcept {
    double const v = in.number() * step.scale + step.offset;
    if (is_integer(step.to_type)) {
        if (!std::isfinite(v)) {
            ++counters_.not_finite;
        } else {
            double const high = static_cast<double>(highest(step.to_type));
            double const rounded = std::nearbyint(v);
            counters_.saturated += rounded > high || rounded < (is_signed(step.to_type) ? -high - 1 : 0) ? 1 : 0;
        }
    }
    return Value::from_number(step.to_type, v);
}

Value Mapping::to_integer(Step const& step, Value const& in) noexcept {
    std::uint64_t const high = highest(step.to_type);
    bool const negative = is_signed(in.type) && in.as_signed() < 0;
    Value out{step.to_type, 0, in.bits, {}};
    if (negative) {
        std::int64_t const low = is_signed(step.to_type) ? -static_cast<std::int64_t>(high) - 1 : 0;
        if (in.as_signed() < low) {
            ++counters_.saturated;
            out.bits = static_cast<std::uint64_t>(low);
        }
    } else if (in.bits > high) {
        ++counters_.saturated;
        out.bits = high;
    }
    return out;
}

/// A bit that the target does not have is left out: the others say what they said. Of a number more than a quality has
/// is a mistake of its writer.
Value Mapping::to_bits(Step const& step, Value const& in) noexcept {
    constexpr std::uint64_t kKnown = (1U << quality::kSampledBits) - 1;
    counters_.saturated += step.to_type == BasicType::quality && is_unsigned(in.type) && in.bits > kKnown ? 1 : 0;
    return {step.to_type, 0, in.bits & step.mask, {}};
}

Value Mapping::convert(Step const& step, Value const& in) noexcept {
    constexpr std::uint64_t kOpen = 1, kClosed = 2;
    switch (step.kind) {
    case Kind::copy: {
        Value out = in;
        out.type = step.to_type;
        out.bits = in.type == BasicType::boolean && step.invert ? 1 - in.bits : in.bits;
        return out;
    }
    case Kind::number:
        return to_number(step, in);
    case Kind::integer:
        return to_integer(step, in);
    case Kind::bits:
        return to_bits(step, in);
    case Kind::boolean_to_position:
        return {BasicType::position, 0, in.boolean() != step.invert ? kOpen : kClosed, {}};
    case Kind::position_to_boolean: // neither open nor closed is not "open"
        return Value::of(in.bits == (step.invert ? kClosed : kOpen));
    case Kind::code_to_position: { // what no position has as its code is a bad one
        constexpr std::uint64_t kBad = 3;
        counters_.saturated += in.bits > kBad ? 1 : 0;
        return {BasicType::position, 0, std::min(in.bits, kBad), {}};
    }
    case Kind::time_to_nanoseconds:
        return Value::integer(BasicType::int64, in.time().nanoseconds());
    case Kind::nanoseconds_to_time:
        return Value::of(UtcTime::from_nanoseconds(std::max<std::int64_t>(0, in.as_signed()), 0x0A));
    default:
        return step.constant;
    }
}

void Mapping::apply(std::span<Value const> in, std::span<Value> out) noexcept {
    for (Step const& step : steps_) {
        out[step.to] = step.kind == Kind::constant ? step.constant : convert(step, in[step.from]);
    }
    ++counters_.applied;
}

} // namespace gridspace::mapping
