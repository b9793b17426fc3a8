// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/wire.hpp"

#include "bus/node_core.hpp"
#include "bus/wire_impl.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::bus {
namespace {

/// What a frame takes of a bound: small frames in great number count, too.
constexpr std::size_t kept(std::size_t octets) {
    return octets + sizeof(WireFrame);
}

} // namespace

void WireReader::Impl::due(lockstep::FrameBuffer frame, SimTime time) {
    frame->time = time;
    waiting.push_back(std::move(frame));
}

WireReader::WireReader(Node& node, std::string link, std::uint16_t ethertype)
    : impl_{std::make_shared<Impl>(node.core())} {
    impl_->link = std::move(link);
    impl_->ethertype = ethertype;
    node.core().wire_readers.push_back(impl_);
}

WireReader::~WireReader() = default;

void WireReader::bound(std::size_t octets) {
    std::lock_guard const lock{impl_->core.mutex};
    impl_->bound = octets;
}

std::uint64_t WireReader::dropped() const {
    std::lock_guard const lock{impl_->core.mutex};
    return impl_->dropped;
}

void WireReader::not_fetched(std::uint64_t total) {
    std::lock_guard const lock{impl_->core.mutex};
    impl_->not_fetched = total;
}

bool WireReader::push(std::span<std::byte const> frame, std::int64_t kernel_ns, std::uint32_t port,
                      std::int64_t arrived_ns) {
    Impl& r = *impl_;
    Node::Core& core = r.core;
    std::lock_guard const lock{core.mutex};
    if (core.wire_book == nullptr || (core.joining && core.config.incarnation > 0)) {
        return true; // before the start, or meant for an earlier incarnation
    }
    if (!core.lockstep()) { // there the ledgers and the evictions of the book are the bound
        if (r.kept_octets + kept(frame.size()) > r.bound) {
            ++r.dropped;
            return false;
        }
        r.kept_octets += kept(frame.size());
    }
    if (r.free.empty()) {
        r.free.push_back(std::make_unique<WireFrame>());
    }
    lockstep::FrameBuffer stored = std::move(r.free.back());
    r.free.pop_back();
    stored->octets.assign(frame.begin(), frame.end());
    stored->kernel_ns = kernel_ns;
    stored->arrived_ns = arrived_ns;
    stored->port = port;
    if (!core.lockstep()) {
        r.due(std::move(stored), core.time_now());
        ++core.input_generation;
        core.notify();
        return true;
    }
    auto arrival = core.wire_book->arrived(r.channel, std::move(stored));
    if (arrival.evicted != nullptr) {
        r.free.push_back(std::move(arrival.evicted));
    }
    if (arrival.due != nullptr) {
        r.due(std::move(arrival.due), core.base.from_nanoseconds(arrival.send_time_ns));
        if (core.gate->granted().has_value()) {
            core.notify();
        }
    }
    return true;
}

std::span<WireFrame const* const> WireReader::take() {
    Impl& r = *impl_;
    std::lock_guard const lock{r.core.mutex};
    for (lockstep::FrameBuffer& frame : r.taken) {
        r.kept_octets -= r.core.lockstep() ? 0 : kept(frame->octets.size());
        r.free.push_back(std::move(frame));
    }
    r.taken.clear();
    r.out.clear();
    auto const later = std::partition(r.waiting.begin(), r.waiting.end(),
                                      [&](lockstep::FrameBuffer const& frame) { return frame->time <= r.until; });
    r.taken.insert(r.taken.end(), std::make_move_iterator(r.waiting.begin()), std::make_move_iterator(later));
    r.waiting.erase(r.waiting.begin(), later);
    for (lockstep::FrameBuffer const& frame : r.taken) {
        r.out.push_back(frame.get());
    }
    if (r.core.lockstep()) {
        std::sort(r.out.begin(), r.out.end(), [](WireFrame const* a, WireFrame const* b) {
            return a->time != b->time ? a->time < b->time : a->octets < b->octets;
        });
    }
    return r.out;
}

std::optional<SimTime> WireReader::next() const {
    Impl const& r = *impl_;
    std::lock_guard const lock{r.core.mutex};
    std::optional<SimTime> out;
    for (lockstep::FrameBuffer const& frame : r.waiting) {
        out = out ? std::min(*out, frame->time) : frame->time;
    }
    return out;
}

WireWriter::WireWriter(Node& node, std::string link, std::uint16_t ethertype) : node_{node} {
    auto& writers = node.core().wire_writers;
    slot_ = writers.size();
    WireLedgerEntry entry;
    entry.link(link.c_str());
    entry.ethertype(ethertype);
    entry.frames().reserve(MAX_FRAMES_PER_TICK);
    writers.push_back(std::move(entry));
}

void WireWriter::sent(std::span<std::byte const> frame, SimTime at) {
    Node::Core& core = node_.core();
    WireLedgerEntry& entry = core.wire_writers[slot_];
    entry.sent(entry.sent() + 1);
    if (!core.lockstep()) {
        return;
    }
    if (entry.frames().size() >= MAX_FRAMES_PER_TICK) {
        core.fail({ExitCode::stall,
                   fmt::format("more than {} frames on '{}' in one tick", MAX_FRAMES_PER_TICK, entry.link().c_str()),
                   "a shorter tick (clock.tick_samples), or fewer frames"});
        return;
    }
    FrameRecord record;
    record.send_time_ns(core.base.nanoseconds(at));
    record.identity(lockstep::frame_identity(frame));
    entry.frames().push_back(record);
}

void Node::Core::take_wire_ledger(std::size_t process, ClockAck const& received) {
    if (wire_readers.empty() || (joining && config.incarnation > 0)) {
        return;
    }
    for (WireLedgerEntry const& entry : received.wires()) {
        std::size_t const channel = wire_book->channel_index(entry.link().c_str(), entry.ethertype());
        if (channel == lockstep::WireBook::kUnknown) {
            continue;
        }
        wire_records.clear();
        for (FrameRecord const& record : entry.frames()) {
            wire_records.push_back({record.send_time_ns(), record.identity()});
        }
        WireReader::Impl& reader = *wire_readers[channel];
        wire_book->announced(process, received.incarnation(), channel, wire_records,
                             [&](lockstep::FrameBuffer frame, std::int64_t send_time_ns) {
                                 reader.due(std::move(frame), base.from_nanoseconds(send_time_ns));
                             });
    }
}

void Node::Core::release_wires(SimTime until) {
    for (auto const& reader : wire_readers) {
        reader->until = until;
    }
}

} // namespace gridspace::bus
