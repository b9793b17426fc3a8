// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What a process writes with, counted for the ledger, and the reader of any type.
#include "bus/node.hpp"
#include "bus/node_core.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::bus {

CountedWriter::CountedWriter(Node::Core& core, std::unique_ptr<RawWriter> raw, std::size_t slot)
    : core_{core}, slot_{slot}, raw_{raw.get()} {
    core_.writers[slot_].raw = std::move(raw);
}

CountedWriter::~CountedWriter() {
    core_.writers[slot_].raw.reset();
}

void CountedWriter::write_at(void const* sample, SimTime at) {
    count(raw_->write(sample, core_.lockstep() ? std::optional{core_.source_ns(at)} : std::nullopt));
}

void CountedWriter::write_cdr_at(std::span<std::byte const> cdr, SimTime at, KeyHash const* key_hash) {
    count(raw_->write_cdr(cdr, core_.lockstep() ? std::optional{core_.source_ns(at)} : std::nullopt, key_hash));
}

void CountedWriter::count(bool accepted) {
    if (accepted) {
        ++core_.writers[slot_].sent;
        return;
    }
    ++core_.refused_writes;
    if (core_.lockstep()) {
        core_.fail({ExitCode::stall, fmt::format("DDS refused a sample of '{}'", core_.writers[slot_].topic),
                    "more instances than its QoS profile allows?"});
    }
}

std::vector<Received<CdrSample>> CdrReader::take() {
    std::lock_guard const lock{mutex_};
    auto const later =
        std::partition(waiting_.begin(), waiting_.end(), [&](auto const& r) { return r.origin.time <= until_; });
    std::vector<Received<CdrSample>> due{std::make_move_iterator(waiting_.begin()), std::make_move_iterator(later)};
    waiting_.erase(waiting_.begin(), later);
    for (auto const& received : due) {
        waiting_octets_ -= received.value.cdr.size();
    }
    std::sort(due.begin(), due.end(), [](auto const& a, auto const& b) { return a.origin < b.origin; });
    return due;
}

void CdrReader::bound(std::size_t octets) {
    std::lock_guard const lock{mutex_};
    bound_ = octets;
}

std::uint64_t CdrReader::dropped() const {
    std::lock_guard const lock{mutex_};
    return dropped_;
}

bool CdrReader::push(std::span<std::byte const> cdr, Origin origin, TimeBase const&) {
    std::lock_guard const lock{mutex_};
    if (waiting_octets_ + cdr.size() > bound_) {
        ++dropped_;
        return true;
    }
    waiting_octets_ += cdr.size();
    waiting_.push_back({origin, {{cdr.begin(), cdr.end()}}});
    return true;
}

bool CdrReader::has_due(SimTime until) const {
    std::lock_guard const lock{mutex_};
    return std::any_of(waiting_.begin(), waiting_.end(), [&](auto const& r) { return r.origin.time <= until; });
}

} // namespace gridspace::bus
