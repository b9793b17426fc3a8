// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What a node does with samples of its topics, on the threads that receive them.
#include "bus/node_core.hpp"
#include "common/log.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace gridspace::bus {

std::size_t Node::Core::stranger_number(std::string const& name) {
    constexpr std::size_t kMostStrangers = 256; // names are invented easily
    auto const found = std::find(strangers.begin(), strangers.end(), name);
    if (found == strangers.end() && !name.empty() && strangers.size() < kMostStrangers) {
        strangers.push_back(name);
        return strangers.size() - 1;
    }
    return found == strangers.end() ? kMostStrangers : static_cast<std::size_t>(found - strangers.begin());
}

Node::Core::ReaderSlot::Source const& Node::Core::source_of(ReaderSlot& slot, SampleHeader const& header) {
    if (header.source >= slot.sources.size()) {
        slot.sources.resize(header.source + 1);
    }
    ReaderSlot::Source& source = slot.sources[header.source];
    if (source.known) {
        return source;
    }
    Peer const peer = slot.network->peer(header.peer);
    source = {true, book->process_index(peer.process), peer.incarnation, peer.process, false, 0};
    if (source.process == lockstep::LedgerBook::kUnknown && !lockstep()) {
        std::lock_guard const lock{mutex};
        source.stranger = stranger_number(peer.process);
    }
    if (lockstep() && source.process != lockstep::LedgerBook::kUnknown && !slot.diagnostic) {
        auto const expected = config.expected_writers.find(slot.topic);
        source.unexpected = expected != config.expected_writers.end() && !expected->second.contains(peer.process);
    }
    return source;
}

bool Node::Core::count_sample(ReaderSlot const& slot, ReaderSlot::Source const& source, SampleHeader const& header,
                              SimTime time) {
    using Arrival = lockstep::LedgerBook::Arrival;
    bool const counted = lockstep() && !slot.diagnostic;
    Arrival const arrival = book->arrived(source.process, source.incarnation, slot.book_reader, header.writer,
                                          header.sequence, counted ? time.quanta : INT64_MAX);
    if (arrival == Arrival::late) {
        fail_locked(
            {ExitCode::stall,
             fmt::format("a sample of '{}' from {} came for {} s, which {} had acknowledged without it", slot.topic,
                         source.name, shortest(base.seconds(time)), source.name),
             "a member writes all that belongs to a tick before it acknowledges it, and counts it in its ledger"});
    }
    if (arrival == Arrival::gap) {
        ++lost_samples;
        if (lockstep()) {
            fail_locked({ExitCode::stall,
                         fmt::format("a sample of '{}' from {} is lost: number {} came after a gap", slot.topic,
                                     source.name, header.sequence),
                         "the depth of its QoS profile is too small for this tick, or a socket buffer is"});
            return false;
        }
    }
    return arrival != Arrival::repeated && arrival != Arrival::late;
}

void Node::Core::on_data_sample(ReaderSlot& slot, std::span<std::byte const> cdr, SampleHeader const& header) {
    ReaderSlot::Source const& source = source_of(slot, header);
    bool const is_stranger = source.process == lockstep::LedgerBook::kUnknown;
    Origin origin;
    origin.writer = header.writer;
    origin.sequence = header.sequence;
    origin.process = static_cast<std::uint32_t>(is_stranger ? book->process_count() + source.stranger : source.process);
    if (is_stranger) {
        ++foreign_samples;
        if (lockstep()) {
            return; // a run must not depend on who else is on the bus
        }
    }
    // Counted and stored under one lock: what the ledger calls complete must be there to be taken.
    std::lock_guard const lock{mutex};
    if (!is_stranger && !is_from_member(*slot.network, header.peer, source.name, source.incarnation)) {
        return;
    }
    if (source.unexpected) {
        fail_locked({ExitCode::usage,
                     fmt::format("{} writes '{}', which the scenario does not say", source.name, slot.topic),
                     "in lockstep the order of the processes follows from who writes what: add the topic to its "
                     "`writes`"});
        return;
    }
    if (joining && config.incarnation > 0) {
        return; // sent before this incarnation was ready: part of the baseline
    }
    origin.time = lockstep() ? time_of(header) : time_now();
    if (!is_stranger && !count_sample(slot, source, header, origin.time)) {
        return;
    }
    if (!slot.inbox->push(cdr, origin, base)) {
        if (is_stranger) {
            if (!std::exchange(slot.undecodable_is_said, true)) {
                log::warning("'{}': {}, which is not of this run, sends samples that cannot be decoded: another IDL? "
                             "they are left out",
                             slot.topic, source.name.empty() ? "a process without a name" : source.name);
            }
            return;
        }
        fail_locked({ExitCode::environment,
                     fmt::format("a sample of '{}' from {} cannot be decoded", slot.topic, source.name),
                     "both sides must be built from the same IDL"});
        return;
    }
    ++input_generation;
    if (!lockstep() ||
        (is_simulator() ? server_waits_no_more && server_waits_no_more() : gate->granted().has_value())) {
        notify();
    }
}

} // namespace gridspace::bus
