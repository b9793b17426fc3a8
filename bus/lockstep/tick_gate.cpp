// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/lockstep/tick_gate.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::lockstep {

TickGate::TickGate(Config config, LedgerBook& book, WireBook const* wires)
    : book_{book}, wires_{wires}, simulator_{book.process_index(config.simulator)} {
    std::sort(config.members.begin(), config.members.end());
    auto const member_index = [&](std::string const& name) -> std::optional<std::size_t> {
        auto const it = std::lower_bound(config.members.begin(), config.members.end(), name);
        if (it == config.members.end() || *it != name) {
            return std::nullopt;
        }
        return static_cast<std::size_t>(it - config.members.begin());
    };
    self_member_ = member_index(config.self);
    for (std::string const& name : config.upstream) {
        std::size_t const process = book.process_index(name);
        auto const member = member_index(name);
        if (process != LedgerBook::kUnknown && member) {
            bool const late = std::find(config.late.begin(), config.late.end(), name) != config.late.end();
            Upstream& upstream = upstream_.emplace_back();
            upstream.process = process;
            upstream.member = *member;
            upstream.late = late;
        }
    }
}

void TickGate::on_clock(std::uint64_t tick, std::span<std::uint8_t const> awaited, bool final) {
    latest_ = tick;
    for (Upstream& upstream : upstream_) {
        upstream.awaited_before = upstream.awaited;
        if (bit_of(awaited, upstream.member)) {
            upstream.awaited = static_cast<std::int64_t>(tick);
        }
    }
    if (self_member_ && bit_of(awaited, *self_member_)) {
        pending_ = Pending{tick, final};
    }
}

void TickGate::on_ack(std::size_t process, std::uint64_t tick) {
    for (Upstream& upstream : upstream_) {
        if (upstream.process == process) {
            upstream.acked = std::max(upstream.acked, static_cast<std::int64_t>(tick));
        }
    }
}

bool TickGate::holds_acknowledgements() const {
    return pending_ && std::ranges::all_of(upstream_, [](Upstream const& upstream) { return upstream.is_here(); });
}

bool TickGate::holds_samples() const {
    return holds_acknowledgements() && (simulator_ == LedgerBook::kUnknown || book_.complete(simulator_)) &&
           std::ranges::all_of(upstream_, [&](Upstream const& upstream) { return book_.complete(upstream.process); });
}

bool TickGate::lacks_only_samples() const {
    return holds_acknowledgements() && !holds_samples();
}

bool TickGate::holds_frames() const {
    return wires_ == nullptr ||
           std::ranges::all_of(upstream_, [&](Upstream const& upstream) { return wires_->complete(upstream.process); });
}

bool TickGate::lacks_only_frames() const {
    return holds_samples() && !holds_frames();
}

std::optional<TickGate::Grant> TickGate::granted() const {
    return holds_samples() && holds_frames() ? std::optional{Grant{pending_->tick, pending_->final}} : std::nullopt;
}

std::string TickGate::awaiting() const {
    if (!pending_) {
        return fmt::format("the next clock of {} (newest: tick {})",
                           simulator_ == LedgerBook::kUnknown ? "the simulator" : book_.process_name(simulator_),
                           latest_);
    }
    std::string out;
    auto const add = [&](std::string const& text) { out += (out.empty() ? "" : "; ") + text; };
    if (simulator_ != LedgerBook::kUnknown && !book_.complete(simulator_)) {
        add(book_.missing(simulator_));
    }
    for (Upstream const& upstream : upstream_) {
        if (!upstream.is_here()) {
            add(fmt::format("the acknowledgement of tick {} by {}",
                            upstream.late ? upstream.awaited_before : upstream.awaited,
                            book_.process_name(upstream.process)));
        }
        if (!book_.complete(upstream.process)) {
            add(book_.missing(upstream.process));
        }
        if (wires_ != nullptr && !wires_->complete(upstream.process)) {
            add(fmt::format("{} from {}", wires_->missing(upstream.process), book_.process_name(upstream.process)));
        }
    }
    return out;
}

} // namespace gridspace::lockstep
