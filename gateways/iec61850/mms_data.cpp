// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/mms_data.hpp"

#include "gateways/iec61850/quality.hpp"

#include <algorithm>

namespace gridspace::iec61850 {
namespace {

using namespace data_tag;

bool plausible(Tlv const& e) noexcept {
    std::size_t const n = e.value.size();
    switch (e.tag) {
    case kBoolean:
        return n == 1;
    case kBitString:
        return n >= 1 && e.value[0] <= (n == 1 ? 0 : 7);
    case kInteger:
        return n >= 1 && n <= 9;
    case kUnsigned:
        return n >= 1 && n <= 9;
    case kFloat:
        return (n == 5 && e.value[0] == 8) || (n == 9 && e.value[0] == 11);
    case kTimeOfDay:
        return n == 4 || n == 6;
    case kUtcTime:
        return n == 8;
    default:
        return true;
    }
}

/// Two's complement of up to 9 octets; nothing when it needs more than 64 bits.
std::optional<std::int64_t> signed_of(Octets v) noexcept {
    if (v.size() == 9) {
        bool const sign = (v[1] & 0x80U) != 0;
        if (v[0] != (sign ? 0xFF : 0x00)) {
            return std::nullopt;
        }
        v = v.subspan(1);
    }
    std::uint64_t bits = load_be(v);
    if (v.size() < 8) {
        std::uint64_t const sign = std::uint64_t{1} << (8 * v.size() - 1);
        bits = (bits ^ sign) - sign;
    }
    return static_cast<std::int64_t>(bits);
}

/// Bits of a bit string, bit 0 first on the wire; nothing when there are more than 64.
std::optional<Value> bits_of(Tlv const& e, BasicType type) noexcept {
    std::size_t const count = (e.value.size() - 1) * 8 - e.value[0];
    if (count > 64) {
        return std::nullopt;
    }
    Value out;
    out.type = type;
    out.bit_count = static_cast<std::uint8_t>(count);
    for (std::size_t i = 0; i < count; ++i) {
        if ((e.value[1 + i / 8] & (0x80U >> (i % 8))) != 0) {
            out.bits |= std::uint64_t{1} << i;
        }
    }
    return out;
}

std::optional<Value> integer_of(Tlv const& e, BasicType type) noexcept {
    std::size_t const width = 8 * integer_octets(type);
    if (e.tag == kUnsigned) {
        std::uint64_t bits = 0;
        if (read_unsigned(e.value, bits) != Reason::none) {
            return std::nullopt;
        }
        std::uint64_t const high = ~std::uint64_t{0} >> (64 - width + (is_signed(type) ? 1 : 0));
        return bits > high ? std::nullopt : std::optional{Value{type, 0, bits, {}}};
    }
    auto const v = signed_of(e.value);
    if (!v) {
        return std::nullopt;
    }
    if (is_unsigned(type)) {
        bool const fits = *v >= 0 && static_cast<std::uint64_t>(*v) <= ~std::uint64_t{0} >> (64 - width);
        return fits ? std::optional{Value::integer(type, *v)} : std::nullopt;
    }
    auto const high = static_cast<std::int64_t>(~std::uint64_t{0} >> (65 - width));
    return *v > high || *v < -high - 1 ? std::nullopt : std::optional{Value::integer(type, *v)};
}

/// The type whose values an element of this tag and length holds.
std::optional<BasicType> natural_type(Tlv const& e) noexcept {
    switch (e.tag) {
    case kBoolean:
        return BasicType::boolean;
    case kBitString: {
        std::size_t const bits = e.value.empty() ? 0 : (e.value.size() - 1) * 8 - e.value[0];
        return bits == quality::kBits ? BasicType::quality : bits == 2 ? BasicType::position : BasicType::bit_string;
    }
    case kInteger:
        return BasicType::int64;
    case kUnsigned:
        return BasicType::uint64;
    case kFloat:
        return e.value.size() == 5 ? BasicType::float32 : BasicType::float64;
    case kOctetString:
        return BasicType::octet_string;
    case kVisibleString:
    case kMmsString:
        return BasicType::visible_string;
    case kTimeOfDay:
        return BasicType::entry_time;
    case kUtcTime:
        return BasicType::timestamp;
    default:
        return std::nullopt;
    }
}

/// The members of a data set without structures, as nearly all are; nothing where there is one, or anything wrong.
std::optional<std::uint32_t> members_of_flat(Octets all_data, std::uint32_t offset) noexcept {
    BerCursor cursor{all_data, offset};
    Tlv element;
    std::uint32_t members = 0;
    for (; !cursor.at_end(); ++members) {
        if (cursor.next(element) != Reason::none || is_container(element.tag) || !plausible(element)) {
            return std::nullopt;
        }
    }
    return members;
}

} // namespace

DataWalker::DataWalker(Octets all_data, std::uint32_t offset) noexcept
    : stack_{[&]<std::size_t... I>(std::index_sequence<I...>) {
          return std::array<BerCursor, kMaxDepth + 1>{((void)I, BerCursor{all_data, offset})...};
      }(std::make_index_sequence<kMaxDepth + 1>{})} {}

bool DataWalker::next(Tlv& out) noexcept {
    if (error_.reason != Reason::none) {
        return false;
    }
    while (stack_[level_].at_end()) {
        if (level_ == 0) {
            return false;
        }
        --level_;
    }
    if (Reason const reason = stack_[level_].next(out); reason != Reason::none) {
        error_ = out.error(reason);
        return false;
    }
    depth_ = level_;
    if (is_container(out.tag)) {
        if (level_ == kMaxDepth) {
            error_ = out.error(Reason::too_deep);
            return false;
        }
        stack_[++level_] = BerCursor{out};
    } else if (!plausible(out)) {
        error_ = out.error(Reason::bad_value);
        return false;
    }
    return true;
}

Decoded<std::uint32_t> check_data(Octets all_data, std::uint32_t offset) noexcept {
    if (auto const members = members_of_flat(all_data, offset)) [[likely]] {
        return *members;
    }
    DataWalker walker{all_data, offset};
    Tlv element;
    std::uint32_t members = 0;
    while (walker.next(element)) {
        members += walker.depth() == 0 ? 1 : 0;
    }
    if (walker.error().reason != Reason::none) {
        return std::unexpected{walker.error()};
    }
    return members;
}

std::optional<Value> read_data_value(Tlv const& e, BasicType type) noexcept {
    if (!plausible(e)) {
        return std::nullopt;
    }
    if (is_integer(type)) {
        return e.tag == kInteger || e.tag == kUnsigned ? integer_of(e, type) : std::nullopt;
    }
    std::uint32_t const tag = type == BasicType::visible_string && e.tag == kMmsString ? kVisibleString : e.tag;
    if (tag != data_tag_of(type)) {
        return std::nullopt;
    }
    Value out;
    out.type = type;
    switch (type) {
    case BasicType::boolean:
        out.bits = e.value[0] != 0 ? 1 : 0;
        return out;
    case BasicType::float32:
    case BasicType::float64:
        if (e.value.size() != (type == BasicType::float32 ? 5U : 9U)) {
            return std::nullopt;
        }
        out.bits = load_be(e.value.subspan(1));
        return out;
    case BasicType::bit_string:
        return bits_of(e, type);
    case BasicType::quality:
    case BasicType::position: {
        auto value = bits_of(e, type);
        if (!value || value->bit_count != (type == BasicType::quality ? quality::kBits : 2U)) {
            return std::nullopt;
        }
        value->bit_count = 0;
        if (type == BasicType::position) { // a number of two bits: the first on the wire is the high one
            value->bits = (value->bits & 1U) << 1U | value->bits >> 1U;
        }
        return value;
    }
    case BasicType::timestamp:
        out.bits = load_be(e.value);
        return out;
    case BasicType::entry_time:
        if (e.value.size() != 6) {
            return std::nullopt;
        }
        out.bits = load_be(e.value);
        return out;
    default:
        out.text = e.value;
        return out;
    }
}

std::optional<Value> read_any_data_value(Tlv const& element) noexcept {
    if (!plausible(element)) {
        return std::nullopt;
    }
    auto const type = natural_type(element);
    return type ? read_data_value(element, *type) : std::nullopt;
}

std::uint8_t data_tag_of(BasicType type) noexcept {
    std::uint32_t tag = kInteger;
    switch (type) {
    case BasicType::boolean:
        tag = kBoolean;
        break;
    case BasicType::position:
    case BasicType::bit_string:
    case BasicType::quality:
        tag = kBitString;
        break;
    case BasicType::float32:
    case BasicType::float64:
        tag = kFloat;
        break;
    case BasicType::timestamp:
        tag = kUtcTime;
        break;
    case BasicType::entry_time:
        tag = kTimeOfDay;
        break;
    case BasicType::visible_string:
        tag = kVisibleString;
        break;
    case BasicType::octet_string:
        tag = kOctetString;
        break;
    default:
        tag = is_unsigned(type) ? kUnsigned : kInteger;
    }
    return static_cast<std::uint8_t>(tag);
}

std::size_t data_content_octets(Value const& value, IntegerForm form) noexcept {
    switch (value.type) {
    case BasicType::boolean:
        return 1;
    case BasicType::float32:
        return 5;
    case BasicType::float64:
        return 9;
    case BasicType::position:
        return 2;
    case BasicType::quality:
        return 3;
    case BasicType::bit_string:
        return 1 + (std::size_t{value.bit_count} + 7) / 8;
    case BasicType::timestamp:
        return 8;
    case BasicType::entry_time:
        return 6;
    case BasicType::visible_string:
    case BasicType::octet_string:
        return value.text.size();
    default:
        if (form == IntegerForm::fixed) {
            return integer_octets(value.type) + 1;
        }
        return is_unsigned(value.type) ? minimal_unsigned_octets(value.bits) : minimal_signed_octets(value.as_signed());
    }
}

void write_data_value(BerWriter& out, Value const& value, IntegerForm form) noexcept {
    std::size_t const octets = data_content_octets(value, form);
    out.head(data_tag_of(value.type), octets);
    switch (value.type) {
    case BasicType::boolean:
        out.octet(value.boolean() ? 1 : 0);
        return;
    case BasicType::float32:
        out.octet(8);
        out.integer(value.bits, 4);
        return;
    case BasicType::float64:
        out.octet(11);
        out.integer(value.bits, 8);
        return;
    case BasicType::position:
        out.octet(6);
        out.octet(static_cast<std::uint8_t>((value.bits & 3U) << 6U));
        return;
    case BasicType::quality:
    case BasicType::bit_string: {
        unsigned const count = value.type == BasicType::quality ? quality::kBits : value.bit_count;
        out.octet(static_cast<std::uint8_t>((8 * (octets - 1)) - count));
        for (std::size_t first = 0; first < count; first += 8) {
            unsigned octet = 0;
            for (std::size_t i = first; i < std::min<std::size_t>(first + 8, count); ++i) {
                octet |= (value.bits >> i & 1U) != 0 ? 0x80U >> (i - first) : 0U;
            }
            out.octet(static_cast<std::uint8_t>(octet));
        }
        return;
    }
    case BasicType::timestamp:
    case BasicType::entry_time:
        out.integer(value.bits, octets);
        return;
    case BasicType::visible_string:
    case BasicType::octet_string:
        out.octets(value.text);
        return;
    default:
        out.integer(value.bits, octets, is_signed(value.type) && value.as_signed() < 0 ? 0xFF : 0x00);
    }
}

} // namespace gridspace::iec61850
