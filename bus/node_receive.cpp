// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What a node does with clocks and acknowledgements, on the threads that receive them. Samples: node_samples.cpp.
#include "bus/machine.hpp"
#include "bus/node_core.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::bus {
namespace {

std::int64_t wall_clock_ns() {
    auto const utc = std::chrono::system_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::nanoseconds>(utc).count();
}

std::int64_t steady_clock_ns() {
    auto const since_start = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::nanoseconds>(since_start).count();
}

} // namespace

SimTime Node::Core::time_now() const {
    if (!has_clock()) {
        return base.from_nanoseconds(wall_clock_ns() - epoch_ns);
    }
    if (lockstep() || is_simulator() || !clock_seen || pace.last_arrived == pace.first_arrived) {
        return latest_time;
    }
    constexpr double kLongestGapS = 0.02; // the simulator may be late, or paused
    using Seconds = std::chrono::duration<double>;
    double const arrived_s = Seconds{pace.last_arrived - pace.first_arrived}.count();
    double const sent_s = static_cast<double>(pace.last_sent_ns - pace.first_sent_ns) / 1e9;
    double const quanta_per_s = static_cast<double>((latest_time - pace.first).quanta) / std::max(arrived_s, sent_s);
    double const since_s =
        std::min(kLongestGapS, Seconds{std::chrono::steady_clock::now() - pace.last_arrived}.count());
    newest_now = std::max(newest_now, latest_time + SimSpan{static_cast<std::int64_t>(quanta_per_s * since_s)});
    return newest_now;
}

void Node::Core::watch_clock() {
    std::int64_t const before_ns = steady_clock_ns(), wall_ns = wall_clock_ns();
    if (auto const by = clock_watch.step(before_ns, wall_ns, steady_clock_ns())) {
        fail_locked({ExitCode::environment,
                     fmt::format("the clock of this machine was set {} by {:.3f} s", *by > 0 ? "forward" : "back",
                                 std::abs(static_cast<double>(*by)) / 1e9),
                     "in real time frames are stamped and delays measured with it: let chrony or ntpd finish before "
                     "the run; in lockstep no clock is used"});
    }
}

template <class Ledger>
void Node::Core::take_ledger(std::size_t process, std::uint32_t incarnation, Ledger const& ledger) {
    bool const late_joiner = joining && config.incarnation > 0;
    for (LedgerEntry const& entry : ledger) {
        if (late_joiner) {
            book->baseline(process, incarnation, entry.topic().c_str(), entry.sent());
        } else {
            book->announced(process, incarnation, entry.topic().c_str(), entry.sent());
        }
    }
}

Peer const& Node::Core::writer_of(std::vector<std::optional<Peer>>& sources, SampleHeader const& header) const {
    if (header.source >= sources.size()) {
        sources.resize(header.source + 1);
    }
    std::optional<Peer>& source = sources[header.source];
    if (!source) {
        source = management->peer(header.peer);
    }
    return *source;
}

bool Node::Core::is_from_member(Participant const& network, std::uint32_t peer, std::string const& process,
                                std::uint32_t incarnation) {
    using Standing = lockstep::Roster::Standing;
    auto const has_left = [&](std::uint32_t participant) { return !lockstep() && !network.is_here(participant); };
    Standing const standing = rosters[&network].standing({process, incarnation, peer}, has_left);
    if (standing == Standing::impostor) {
        ++impostor_samples[process]; // names of this run only: bounded
    }
    return standing == Standing::member;
}

void Node::Core::settle_rosters() {
    if (!has_clock()) {
        return; // nobody says when a process begins again
    }
    for (Participant const* network : {management.get(), data.get()}) {
        if (network == nullptr) {
            continue;
        }
        std::vector<lockstep::Roster::Claim> here;
        for (std::uint32_t const index : network->here()) {
            Peer const peer = network->peer(index);
            here.push_back({peer.process, peer.incarnation, index});
        }
        rosters[network].settle(here);
    }
}

bool Node::Core::clock_fits(SampleHeader const& header) {
    if (clock.state() == CLOCK_ABORTED) {
        return true; // it may have ended before it began to count
    }
    constexpr std::int64_t kSlackNs = 1000; // the stamps of DDS count in 2^-32 s
    Rational const quantum = config.clock.quantum_s;
    SimTime const now{clock.quanta()};
    std::int64_t const in_ticks = tick_span.quanta * static_cast<std::int64_t>(clock.tick());
    std::int64_t const off_ns = stamp_after(header.source_ns, source_ns(now));
    std::string mismatch;
    if (quantum.num() != clock.quantum_num() || quantum.den() != clock.quantum_den()) {
        mismatch = fmt::format("counts in steps of {}/{} s, and this process in {} s", clock.quantum_num(),
                               clock.quantum_den(), quantum.to_string());
    } else if (lockstep() && now.quanta != in_ticks && clock.state() != CLOCK_FINAL) { // the last one may be shorter
        mismatch = fmt::format("is at {} s in tick {}, and a tick of this process is {} s", shortest(base.seconds(now)),
                               clock.tick(), config.clock.tick_s.to_string());
    } else if (lockstep() && std::llabs(off_ns) > kSlackNs) {
        mismatch =
            fmt::format("has another epoch than this process, by {} s", shortest(static_cast<double>(off_ns) / 1e9));
    }
    if (!mismatch.empty()) {
        fail_locked({ExitCode::usage, fmt::format("the clock of '{}' {}", config.clock.simulator, mismatch),
                     "the configuration of this process is that of another scenario, or of an older one: make it again "
                     "(on a board: its bundle)"});
    }
    return mismatch.empty();
}

void Node::Core::on_clock_sample(std::span<std::byte const> cdr, SampleHeader const& header) {
    Peer const& writer = writer_of(clock_sources, header);
    if (writer.process != config.clock.simulator) {
        ++foreign_samples; // of another run, or of somebody who looks on
        return;
    }
    std::lock_guard const lock{mutex};
    if (!is_from_member(*management, header.peer, writer.process, writer.incarnation)) {
        return;
    }
    static thread_local SimClock received; // keeps its capacity
    if (!codec_of<SimClock>().decode(cdr, &received)) {
        fail_locked({ExitCode::environment,
                     "a clock sample cannot be decoded: another version of Gridspace on this domain?", ""});
        return;
    }
    if (board != nullptr && (received.state() == CLOCK_RUNNING || received.state() == CLOCK_FINAL)) {
        return; // for who looks on: here it comes over the board
    }
    std::swap(clock, received);
    take_clock(cdr, header);
    if (lockstep()) {
        return;
    }
    // Not for what comes over the board: that is this machine's own memory, and who reads it late is only late.
    auto const ahead = clock_watch.offset(header.source_ns, wall_clock_ns());
    if (ahead && !(ClockWatch::is_lateness(*ahead) && management->peer(header.peer).machine == this_machine())) {
        fail_locked({ExitCode::environment,
                     fmt::format("the clock of this machine is {:.3f} s {} that of the simulator's machine",
                                 std::abs(static_cast<double>(*ahead)) / 1e9, *ahead > 0 ? "ahead of" : "behind"),
                     "in real time they have to agree: chrony, ntpd or PTP on both; in lockstep no clock is used"});
    }
}

void Node::Core::take_clock(std::span<std::byte const> cdr, SampleHeader const& header) {
    pace.last_arrived = std::chrono::steady_clock::now();
    pace.last_sent_ns = header.source_ns;
    if (!clock_seen) {
        pace.first_sent_ns = header.source_ns;
        pace.first_arrived = pace.last_arrived;
        pace.first = {clock.quanta()};
    }
    if (!clock_fits(header)) {
        return;
    }
    if (lockstep() && !clock_seen && config.incarnation == 0 && clock.tick() > 0 && clock.state() != CLOCK_ABORTED) {
        fail_locked({ExitCode::environment,
                     fmt::format("the run is already under way: its clock is at tick {}", clock.tick()),
                     "in lockstep a program joins before the start, or is restarted by the scenario (`restart:`)"});
        return;
    }
    clock_seen = true;
    if (clock_tap != nullptr && clock.state() != CLOCK_HELD) {
        show_clock(cdr, header);
    }
    ++clock_generation;
    latest_time = {clock.quanta()};
    if (clock.state() == CLOCK_ABORTED) {
        fail_locked({ExitCode::stall,
                     gate->has_pending()
                         ? fmt::format("the simulator has ended the run; this process waited for {}", gate->awaiting())
                         : "the simulator has ended the run",
                     "the simulator's log says why"});
        return;
    }
    std::size_t const simulator = book->process_index(config.clock.simulator);
    if (simulator != lockstep::LedgerBook::kUnknown && (lockstep() || clock.state() == CLOCK_FINAL)) {
        take_ledger(simulator, 0, clock.ledger()); // in real time it only shows what was lost
    }
    if (clock.state() == CLOCK_HELD) {
        for (auto& [network, roster] : rosters) {
            roster.expect_restarts();
        }
    } else if (rosters[management.get()].expects_restarts()) {
        settle_rosters();
    }
    if (lockstep()) {
        if (clock.state() == CLOCK_HELD) {
            on_held_clock();
            return;
        }
        if (!joining) {
            take_tick();
        }
        if (!gate->granted()) {
            return; // the last thing to arrive wakes the process, once
        }
    }
    notify();
}

void Node::Core::show_clock(std::span<std::byte const> cdr, SampleHeader const& header) {
    Origin origin{{clock.quanta()}, 0, header.writer, header.sequence};
    std::size_t const simulator = book->process_index(config.clock.simulator);
    origin.process =
        static_cast<std::uint32_t>(simulator == lockstep::LedgerBook::kUnknown ? book->process_count() : simulator);
    clock_tap->push(cdr, origin, base);
}

void Node::Core::take_tick() {
    gate->on_clock(clock.tick(), clock.awaited(), clock.state() == CLOCK_FINAL);
    std::erase_if(late_acks, [&](auto const& late) {
        bool const its_time = late.second.tick() < clock.tick();
        if (its_time) {
            count_ack(late.first, late.second);
        }
        return its_time;
    });
    pending_since = std::chrono::steady_clock::now();
}

void Node::Core::on_held_clock() {
    if (joining) {
        if (is_late_joiner() && config.joins_at_s && SimTime{} + base.nearest(*config.joins_at_s) <= latest_time) {
            held = Joining{clock.tick(), {clock.awaited().begin(), clock.awaited().end()}};
        }
    } else {
        std::vector<std::string> const& members = config.clock.members; // in the order of names
        auto const self = std::find(members.begin(), members.end(), config.process);
        restate_ledger = self != members.end() &&
                         lockstep::bit_of(clock.awaited(), static_cast<std::size_t>(self - members.begin()));
    }
    notify();
}

void Node::Core::on_ack_sample(std::span<std::byte const> cdr, SampleHeader const& header) {
    Peer const& writer = writer_of(ack_sources, header);
    std::lock_guard const lock{mutex};
    static thread_local ClockAck received; // keeps its capacity: no allocation per acknowledgement
    if (!codec_of<ClockAck>().decode(cdr, &received)) {
        return;
    }
    std::size_t const process = book->process_index(received.member().c_str());
    if (process == lockstep::LedgerBook::kUnknown || writer.process != received.member().c_str() ||
        writer.incarnation != received.incarnation()) {
        ++foreign_samples;
        return;
    }
    if (!is_from_member(*management, header.peer, writer.process, writer.incarnation)) {
        return;
    }
    if (board != nullptr && received.next_tick_needed() != 0) {
        return; // for who looks on
    }
    take_ack(cdr, header, process, received);
}

void Node::Core::take_ack(std::span<std::byte const> cdr, SampleHeader const& header, std::size_t process,
                          ClockAck const& received) {
    bool const is_restated = received.next_tick_needed() == 0;
    if (ack_tap != nullptr && !is_restated) {
        ack_tap->push(cdr, {time_of(header), static_cast<std::uint32_t>(process), header.writer, header.sequence},
                      base);
    }
    auto const& late = config.clock.late_upstream;
    bool const is_late = std::find(late.begin(), late.end(), received.member().c_str()) != late.end();
    if (is_late && !is_restated && !joining && received.tick() >= gate->latest_tick()) {
        late_acks.emplace_back(process, received); // of what is due in later ticks, this one must know nothing
        return;
    }
    count_ack(process, received);
}

void Node::Core::count_ack(std::size_t process, ClockAck const& received) {
    bool const is_restated = received.next_tick_needed() == 0;
    take_ledger(process, received.incarnation(), received.ledger());
    take_wire_ledger(process, received);
    if (joining && is_late_joiner()) {
        ledgers_of[received.member().c_str()] = received.tick();
        notify();
    }
    if (is_restated) {
        return;
    }
    std::int64_t const time_quanta = tick_span.quanta * static_cast<std::int64_t>(received.tick());
    if (std::string const more = book->acknowledged(process, received.incarnation(), time_quanta); !more.empty()) {
        fail_locked(
            {ExitCode::stall,
             fmt::format("{} has acknowledged tick {}: {}", received.member().c_str(), received.tick(), more),
             "a member writes all that belongs to a tick before it acknowledges it, and counts it in its ledger"});
        return;
    }
    gate->on_ack(process, received.tick());
    if (on_ack) {
        on_ack(received);
    }
    if (is_simulator() ? server_waits_no_more && server_waits_no_more() : gate->granted().has_value()) {
        notify();
    }
}

} // namespace gridspace::bus
