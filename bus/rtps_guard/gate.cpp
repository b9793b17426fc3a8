// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/rtps_guard/gate.hpp"

#include <fmt/format.h>

namespace gridspace::rtps_guard {
namespace {

/// Comes in runs where nobody means harm.
bool is_usual(Refusal refusal) {
    return refusal == Refusal::stranger || refusal == Refusal::farewell;
}

} // namespace

Refusal Gate::judge(Examined const& examined, std::int64_t now_ns) {
    if (examined.refusal != Refusal::none || !rules_.speaks_for_itself) {
        return examined.refusal;
    }
    std::lock_guard const lock{mutex_};
    for (std::size_t i = 0; i < examined.announced_count; ++i) {
        if (!known_.announce(examined.announced[i], now_ns)) {
            return Refusal::crowd;
        }
    }
    if (examined.announced_count > 0) {
        return Refusal::none;
    }
    return known_.hear(examined.source, now_ns) ? Refusal::none : Refusal::stranger;
}

void Gate::admit(std::span<std::uint8_t> datagram, std::int64_t now_ns, Deliver const& deliver) {
    Examined const examined = examine(datagram, rules_);
    Refusal const refusal = judge(examined, now_ns);
    if (refusal != Refusal::none) {
        refused_[static_cast<std::size_t>(refusal)].fetch_add(1, std::memory_order_relaxed);
        return;
    }
    datagram = datagram.first(examined.octets);
    if (!examined.has_fragments) {
        deliver(datagram);
        return;
    }
    std::vector<std::vector<std::uint8_t>> messages;
    {
        std::lock_guard const lock{mutex_};
        messages = fragments_.take(datagram, now_ns);
    }
    for (auto const& message : messages) {
        deliver(message);
    }
}

std::uint64_t Gate::refused() const {
    std::uint64_t out = 0;
    for (std::size_t i = 0; i < refused_.size(); ++i) {
        out += is_usual(static_cast<Refusal>(i)) ? 0 : refused_[i].load(std::memory_order_relaxed);
    }
    return out;
}

std::string Gate::text() const {
    std::string out;
    for (std::size_t i = 0; i < refused_.size(); ++i) {
        std::uint64_t const count = refused_[i].load(std::memory_order_relaxed);
        if (count > 0 && !is_usual(static_cast<Refusal>(i))) {
            out += fmt::format("{}{} ({})", out.empty() ? "" : ", ", count, to_string(static_cast<Refusal>(i)));
        }
    }
    return out;
}

} // namespace gridspace::rtps_guard
