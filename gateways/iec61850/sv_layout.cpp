// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/sv_layout.hpp"

#include <algorithm>

namespace gridspace::iec61850 {

std::size_t sv_octets(BasicType type) noexcept {
    switch (type) {
    case BasicType::boolean:
    case BasicType::int8:
    case BasicType::uint8:
        return 1;
    case BasicType::int16:
    case BasicType::uint16:
        return 2;
    case BasicType::int64:
    case BasicType::uint64:
    case BasicType::float64:
    case BasicType::timestamp:
        return 8;
    case BasicType::entry_time:
        return 6;
    case BasicType::visible_string:
        return 35;
    case BasicType::octet_string:
        return 20;
    default: // 32-bit numbers, enumerations, coded enumerations, bit strings and qualities
        return 4;
    }
}

Value read_sv_value(BasicType type, Octets at) noexcept {
    Value value;
    value.type = type;
    if (is_string(type)) {
        auto const end = type == BasicType::visible_string ? std::find(at.begin(), at.end(), 0) : at.end();
        value.text = at.first(static_cast<std::size_t>(end - at.begin()));
        return value;
    }
    value.bits = load_be(at);
    if (is_signed(type) && at.size() < 8) {
        std::uint64_t const sign = std::uint64_t{1} << (8 * at.size() - 1);
        value.bits = (value.bits ^ sign) - sign;
    }
    if (type == BasicType::bit_string) {
        value.bit_count = 32;
    }
    return value;
}

void write_sv_value(Value const& value, std::span<std::uint8_t> at) noexcept {
    if (is_string(value.type)) {
        std::size_t const octets = std::min(value.text.size(), at.size());
        std::copy_n(value.text.begin(), octets, at.begin());
        std::fill(at.begin() + static_cast<std::ptrdiff_t>(octets), at.end(), std::uint8_t{0});
        return;
    }
    std::uint64_t bits = value.bits;
    for (std::size_t i = at.size(); i-- > 0; bits >>= 8U) {
        at[i] = static_cast<std::uint8_t>(bits);
    }
}

SvLayout::SvLayout(DataSet const& data_set) {
    for (Leaf& leaf : leaves_of(data_set)) {
        std::size_t const octets = sv_octets(leaf.type);
        slots_.push_back({std::move(leaf), octets_, octets});
        octets_ += octets;
        all_of_four_octets_ = all_of_four_octets_ && octets == 4;
    }
}

std::optional<std::size_t> SvLayout::index_of(std::string_view name) const noexcept {
    auto const found =
        std::find_if(slots_.begin(), slots_.end(), [&](Slot const& slot) { return slot.leaf.name == name; });
    if (found == slots_.end()) {
        return std::nullopt;
    }
    return static_cast<std::size_t>(found - slots_.begin());
}

} // namespace gridspace::iec61850
