// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/clock_server.hpp"

#include "bus/clock_server_state.hpp"
#include "bus/deadline.hpp"
#include "common/text.hpp"
#include "common/waited_time.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::bus {

ClockServer::ClockServer(Node& node, std::vector<MemberPlan> members)
    : state_{std::make_unique<State>(node, *node.core_, std::move(members))} {}

ClockServer::~ClockServer() {
    state_->status_reader.reset();
    std::lock_guard const lock{state_->core.mutex};
    state_->core.on_ack = {};
    state_->core.server_waits_no_more = {};
    state_->core.who_is_missing = {};
    state_->core.others_present = {};
}

Result<void> ClockServer::start() {
    State& s = *state_;
    auto writer = s.core.management->create_writer("simulation_clock", codec_of<SimClock>());
    if (!writer) {
        return std::unexpected{writer.error()};
    }
    s.clock_writer = std::move(*writer);
    auto reader = s.core.management->create_reader("member_status", codec_of<MemberStatus>(),
                                                   [&s](auto cdr, auto const& header) { s.on_status(cdr, header); });
    if (!reader) {
        return std::unexpected{reader.error()};
    }
    s.status_reader = std::move(*reader);
    {
        std::lock_guard const lock{s.core.mutex};
        s.core.on_ack = [&s](ClockAck const& ack) {
            std::size_t const member = s.barrier.member_index(ack.member().c_str());
            std::uint64_t frames = 0;
            for (WireLedgerEntry const& entry : ack.wires()) {
                frames += entry.frames().size();
            }
            if (member != lockstep::Barrier::kUnknown &&
                !s.barrier.on_ack(member, ack.tick(), ack.next_tick_needed(), frames)) {
                s.core.fail_locked({ExitCode::stall,
                                    fmt::format("{} has acknowledged tick {}, and the newest is {}",
                                                ack.member().c_str(), ack.tick(), s.barrier.tick()),
                                    "a member acknowledges the tick of the clock that it has taken, and no other"});
            }
        };
        s.core.server_waits_no_more = [&s] { return s.barrier.complete() && s.inputs_complete(); };
        s.core.who_is_missing = [&s] { return s.not_ready(); };
        s.core.others_present = [&s] { return s.others_present(); };
    }
    if (auto ok = s.node.start(); !ok) {
        return ok;
    }
    for (MemberPlan const& member : s.plan) {
        if (member.feeds_simulator) {
            s.inputs.push_back(s.core.book->process_index(member.name));
        }
    }
    if (s.core.board != nullptr) {
        s.find_places();
    }
    Rational const quantum = s.core.config.clock.quantum_s;
    s.clock.quantum_num(static_cast<std::uint32_t>(quantum.num()));
    s.clock.quantum_den(static_cast<std::uint32_t>(quantum.den()));
    return s.await_ready("start");
}

void ClockServer::set_start(std::int64_t unix_ns) {
    state_->clock.start_unix_ns(unix_ns);
}

Result<void> ClockServer::tick(SimTime time, bool final) {
    State& s = *state_;
    Node::Core& core = s.core;
    std::uint64_t const number = s.next_tick++;
    {
        std::lock_guard const lock{core.mutex};
        if (core.error) {
            return std::unexpected{*core.error};
        }
        core.latest_time = time;
    }
    if (!s.has_listeners(number, final)) {
        return {};
    }
    if (auto ok = s.send(time, number, final); !ok) {
        return ok;
    }
    if (core.lockstep()) {
        if (auto ok = s.await_members(time, number); !ok) {
            return ok;
        }
    } else if (final) {
        s.end_in_real_time();
        return {};
    }
    if (!final) {
        core.together.emplace(); // until the next clock: what is published leaves with it, in few datagrams
    } else {
        std::lock_guard const lock{core.mutex};
        core.leave_at_once_unless_watched();
    }
    return {};
}

bool ClockServer::State::has_listeners(std::uint64_t number, bool final) {
    if (core.lockstep()) {
        std::lock_guard const lock{core.mutex};
        barrier.open(number, number == 0 || final);
        clock.awaited() = barrier.awaited_bits();
        return barrier.anybody_awaited();
    }
    // Nobody waits for it, and each sample wakes every process: a hundred a second are enough.
    constexpr std::chrono::milliseconds kPeriod{10};
    auto const now = std::chrono::steady_clock::now();
    if (number > 0 && !final && now - sent_at < kPeriod) {
        core.together.emplace(); // what the next tick publishes leaves together
        return false;
    }
    sent_at = now;
    return true;
}

Result<void> ClockServer::State::send(SimTime time, std::uint64_t number, bool final) {
    clock.tick(number);
    clock.time_ns(core.base.nanoseconds(time));
    clock.quanta(time.quanta);
    clock.state(final ? CLOCK_FINAL : CLOCK_RUNNING);
    core.fill_ledger(clock.ledger());
    bool accepted = true;
    if (core.board != nullptr) {
        core.together.reset(); // all data of the tick is sent before the clock
        accepted = post_clock(time);
    }
    if (core.board == nullptr || core.show_to_others(final)) {
        accepted = clock_writer->write(&clock, core.lockstep() ? std::optional{core.source_ns(time)} : std::nullopt) &&
                   accepted;
    }
    core.together.reset();
    return accepted ? Result<void>{} : fail(ExitCode::stall, fmt::format("DDS refused clock sample {}", number));
}

/// Nobody waits in real time, but the end is for all: who has not heard it takes us for dead. A process of the run that
/// is behind catches up; who only listens may be stopped, or gone without a word.
void ClockServer::State::end_in_real_time() {
    constexpr std::chrono::milliseconds kLook{20};
    Deadline const for_the_run{core.config.clock.member_timeout_s};
    while (!for_the_run.passed() && anybody_has_to_hear_the_end()) {
        std::unique_lock lock{core.mutex};
        if (core.error || core.stop_requested) {
            return;
        }
        (void)core.changed.wait_for(lock, kLook);
    }
    Deadline const patience{2};
    (void)clock_writer->wait_acknowledged(patience.left());
    for (Node::Core::WriterSlot const& writer : core.writers) { // what was said last goes with its writer
        if (writer.raw != nullptr && !patience.passed()) {
            (void)writer.raw->wait_acknowledged(patience.left());
        }
    }
}

bool ClockServer::State::anybody_has_to_hear_the_end() {
    std::vector<Peer> const here = clock_writer->matched();
    std::lock_guard const lock{core.mutex};
    return std::ranges::any_of(here, [&](Peer const& peer) {
        auto const known = statuses.find(peer.process);
        return known != statuses.end() && !dropped.contains(peer.process) &&
               known->second.incarnation == peer.incarnation && known->second.state == MEMBER_READY;
    });
}

Result<void> ClockServer::State::await_members(SimTime time, std::uint64_t number) {
    std::unique_lock lock{core.mutex};
    bool const in_time = await_within_patience(lock);
    if (core.error) {
        return std::unexpected{*core.error};
    }
    if (!in_time) {
        return fail(ExitCode::stall,
                    fmt::format("tick {} ({} s): waited {} s for {}", number, shortest(core.base.seconds(time)),
                                shortest(core.config.clock.member_timeout_s), culprits()));
    }
    for (auto& reader : core.readers) {
        // Everything that was sent up to this tick is here; its effect may lie in the future.
        reader->inbox->release({INT64_MAX});
    }
    return {};
}

bool ClockServer::State::await_within_patience(std::unique_lock<std::mutex>& lock) {
    double const patience_s = core.config.clock.member_timeout_s;
    bool in_time = true;
    std::chrono::duration<double> look = WaitedTime::kLook;
    Receiving::Turn turn{Receiving::of_process()};
    for (WaitedTime waited; in_time && !may_go_on();) {
        if (patience_s > 0) {
            look = std::min(look, std::chrono::duration<double>{patience_s} - waited.look());
        }
        core.wait_for_more(turn, lock, std::chrono::duration_cast<std::chrono::nanoseconds>(look), barrier.complete());
        in_time = patience_s <= 0 || waited.look().count() < patience_s;
    }
    if (!in_time) { // where everything was paused, this process may be the first that runs again
        for (auto const until = std::chrono::steady_clock::now() + std::chrono::milliseconds{200};
             !may_go_on() && std::chrono::steady_clock::now() < until;) {
            core.wait_for_more(turn, lock, std::chrono::milliseconds{50}, barrier.complete());
        }
        in_time = may_go_on();
    }
    return in_time;
}

Result<void> ClockServer::await_restarted(std::string const& process, std::uint32_t incarnation) {
    State& s = *state_;
    {
        std::lock_guard const lock{s.core.mutex};
        s.incarnations[process] = incarnation;
        for (auto& [network, roster] : s.core.rosters) {
            roster.expect_restart(process, incarnation);
        }
        s.core.absent.erase(process);
        s.dropped.erase(process); // it is waited for from now on
        s.hold(process);
    }
    s.clock_writer->write(&s.clock, std::optional{s.core.source_ns(s.core.latest_time)});
    s.core.together.reset();
    if (auto ok = s.await_ready(fmt::format("restart of {}", process)); !ok) {
        return ok;
    }
    std::lock_guard const lock{s.core.mutex};
    s.core.settle_rosters();
    if (std::size_t const member = s.barrier.member_index(process); member != lockstep::Barrier::kUnknown) {
        s.barrier.rejoin(member);
    }
    return {};
}

void ClockServer::drop(std::string const& process) {
    std::lock_guard const lock{state_->core.mutex};
    if (std::size_t const member = state_->barrier.member_index(process); member != lockstep::Barrier::kUnknown) {
        state_->barrier.drop(member);
        state_->dropped.insert(process);
        state_->core.absent.insert(process);
    }
}

void ClockServer::rejoin(std::string const& process) {
    std::lock_guard const lock{state_->core.mutex};
    if (std::size_t const member = state_->barrier.member_index(process); member != lockstep::Barrier::kUnknown) {
        state_->barrier.rejoin(member);
        state_->dropped.erase(process);
        state_->core.absent.erase(process);
    }
}

void ClockServer::abort() {
    State& s = *state_;
    s.core.together.reset(); // the run may end between two ticks
    if (s.clock_writer != nullptr) {
        s.clock.state(CLOCK_ABORTED);
        s.clock_writer->write(&s.clock, std::nullopt);
        s.clock_writer->wait_acknowledged(std::chrono::milliseconds{200});
    }
}

std::uint64_t ClockServer::ticks() const {
    return state_->next_tick;
}

} // namespace gridspace::bus
