// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/bump_in_the_wire/delay_line.hpp"

#include <algorithm>
#include <functional>

namespace gridspace::gateways {

bool DelayLine::push(std::int64_t at_ns, std::span<std::uint8_t const> octets) {
    if (heap_.size() >= capacity_) {
        return false;
    }
    if (free_.empty()) {
        free_.push_back(slots_.size());
        slots_.emplace_back();
    }
    std::size_t const slot = free_.back();
    free_.pop_back();
    slots_[slot].assign(octets.begin(), octets.end());
    heap_.push_back({at_ns, order_++, slot});
    std::push_heap(heap_.begin(), heap_.end(), std::greater<>{});
    return true;
}

std::optional<DelayLine::Waiting> DelayLine::pop(std::int64_t until_ns) {
    if (heap_.empty() || heap_.front().at_ns > until_ns) {
        return std::nullopt;
    }
    Entry const entry = heap_.front();
    std::pop_heap(heap_.begin(), heap_.end(), std::greater<>{});
    heap_.pop_back();
    free_.push_back(entry.slot); // its octets stay until the slot is used again
    return Waiting{entry.at_ns, slots_[entry.slot]};
}

std::optional<std::int64_t> DelayLine::next_ns() const {
    return heap_.empty() ? std::nullopt : std::optional{heap_.front().at_ns};
}

} // namespace gridspace::gateways
