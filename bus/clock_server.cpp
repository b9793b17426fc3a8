// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/clock_server.hpp"

#include "bus/deadline.hpp"
#include "bus/node_core.hpp"
#include "bus/start_patience.hpp"
#include "common/text.hpp"
#include "common/waited_time.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <set>

namespace gridspace::bus {

struct ClockServer::State {
    Node& node;
    Node::Core& core;
    std::vector<MemberPlan> plan;
    lockstep::Barrier barrier;
    std::unique_ptr<RawWriter> clock_writer;
    std::unique_ptr<RawReader> status_reader;
    SimClock clock;
    std::uint64_t next_tick{0};
    std::chrono::steady_clock::time_point sent_at; ///< real time: the newest clock sample

    struct Status {
        std::uint32_t incarnation{0};
        MemberState state{MEMBER_STARTING};
        std::map<std::string, std::uint32_t> matched;
        std::string waiting_for;
    };
    std::map<std::string, Status> statuses;            // under core.mutex
    std::map<std::string, std::uint32_t> incarnations; // expected, by process
    std::set<std::string> dropped;                     // the run goes on without them
    std::vector<std::size_t> inputs;                   // processes that feed the simulator, as indices of the book

    static std::vector<lockstep::Barrier::Member> barrier_members(std::vector<MemberPlan> const& plan) {
        std::vector<lockstep::Barrier::Member> members;
        for (MemberPlan const& member : plan) {
            members.push_back({member.name, member.triggered_by, member.late});
        }
        return members;
    }

    State(Node& n, Node::Core& c, std::vector<MemberPlan> members)
        : node{n}, core{c}, plan{std::move(members)},
          barrier{barrier_members(plan), static_cast<std::uint64_t>(c.config.clock.max_lag_ticks)} {}

    void on_status(std::span<std::byte const> cdr, SampleHeader const& header) {
        MemberStatus received;
        if (!codec_of<MemberStatus>().decode(cdr, &received)) {
            return;
        }
        Peer const writer = core.management->peer(header.peer);
        std::lock_guard const lock{core.mutex};
        if (writer.process != received.process().c_str() ||
            !core.is_from_member(*core.management, header.peer, writer.process, writer.incarnation)) {
            return;
        }
        Status& status = statuses[received.process().c_str()];
        if (received.incarnation() < status.incarnation) {
            return;
        }
        status.incarnation = received.incarnation();
        status.state = received.state();
        status.waiting_for = received.waiting_for().c_str();
        status.matched.clear();
        for (MatchedPeer const& peer : received.matched()) {
            status.matched[peer.process().c_str()] = peer.incarnation();
        }
        core.notify();
    }

    /// Who is not READY, or is matched with an incarnation that is gone; whom nobody has heard of comes alone, since
    /// the others wait for it. Under the mutex.
    std::string not_ready() const {
        std::string out, absent;
        for (MemberPlan const& member : plan) {
            if (dropped.contains(member.name)) {
                continue;
            }
            auto const it = statuses.find(member.name);
            std::string why;
            auto const expected = incarnations.find(member.name);
            std::uint32_t const incarnation = expected == incarnations.end() ? 0 : expected->second;
            if (it == statuses.end() || it->second.incarnation < incarnation) {
                absent += fmt::format("{}{} has not appeared on the bus", absent.empty() ? "" : "; ", member.name);
            } else if (it->second.state != MEMBER_READY) {
                why = it->second.waiting_for.empty() ? "is starting" : "waits for " + it->second.waiting_for;
            } else {
                for (auto const& [process, peer_incarnation] : it->second.matched) {
                    auto const newest = incarnations.find(process);
                    if (newest != incarnations.end() && peer_incarnation < newest->second) {
                        why = fmt::format("is not matched with the restarted {}", process);
                    }
                }
            }
            if (!why.empty()) {
                out += fmt::format("{}{} {}", out.empty() ? "" : "; ", member.name, why);
            }
        }
        return absent.empty() ? out : absent;
    }

    /// How far the others have come: each peer that one of them is matched with. Under the mutex.
    std::size_t others_present() const {
        std::size_t present = 0;
        for (auto const& [process, status] : statuses) {
            present += 1 + status.matched.size() + (status.state == MEMBER_READY ? 1 : 0);
        }
        return present;
    }

    bool inputs_complete() const {
        return std::all_of(inputs.begin(), inputs.end(), [&](std::size_t p) { return core.book->complete(p); });
    }

    /// Those at the root of a stall: a member that waits for another missing member is not to blame. Under the mutex.
    std::string culprits() const {
        std::set<std::string> missing;
        for (std::size_t const member : barrier.missing()) {
            missing.insert(barrier.member_name(member));
        }
        std::string out;
        for (MemberPlan const& member : plan) {
            bool const waits_itself = std::any_of(member.upstream.begin(), member.upstream.end(),
                                                  [&](std::string const& up) { return missing.contains(up); });
            if (!missing.contains(member.name) || waits_itself) {
                continue;
            }
            auto const last = barrier.last_ack(barrier.member_index(member.name));
            auto const status = statuses.find(member.name);
            bool const says_why = status != statuses.end() && !status->second.waiting_for.empty();
            out += fmt::format("{}{} ({}{})", out.empty() ? "" : ", ", member.name,
                               last ? fmt::format("last acknowledged tick {}", *last) : "has never acknowledged",
                               says_why ? ", waits for " + status->second.waiting_for : "");
        }
        for (std::size_t const process : inputs) {
            if (std::string const samples = core.book->missing(process); !samples.empty()) {
                out += fmt::format("{}{}", out.empty() ? "" : ", ", samples);
            }
        }
        return out;
    }

    /// The clock sample with the start of the counts for a new incarnation of `process`. Under the mutex.
    void hold(std::string const& process) {
        clock.tick(next_tick - 1);
        clock.time_ns(core.base.nanoseconds(core.latest_time));
        clock.quanta(core.latest_time.quanta);
        clock.state(CLOCK_HELD);
        clock.awaited().assign((plan.size() + 7) / 8, 0);
        for (MemberPlan const& member : plan) {
            if (member.name != process && !dropped.contains(member.name)) {
                std::size_t const i = barrier.member_index(member.name);
                clock.awaited()[i / 8] = static_cast<std::uint8_t>(clock.awaited()[i / 8] | (1U << (i % 8)));
            }
        }
        core.fill_ledger(clock.ledger());
    }

    /// The clock on the board, where each awaited member is woken by the last thing that it waits for.
    bool post_clock(SimTime time) {
        Board& board = *core.board;
        std::int32_t awaited = 0;
        for (MemberPlan const& member : plan) {
            bool const is_awaited = lockstep::bit_of(clock.awaited(), barrier.member_index(member.name));
            std::int32_t things = INT32_MIN / 2; // of who is not asked, nothing is the last
            if (is_awaited) {
                ++awaited;
                things = 1; // the clock itself
                for (std::string const& up : member.upstream) {
                    if (std::find(member.late.begin(), member.late.end(), up) != member.late.end()) {
                        continue;
                    }
                    things += lockstep::bit_of(clock.awaited(), barrier.member_index(up)) ? 1 : 0;
                }
            }
            board.expect(board.place_of(member.name), things);
        }
        board.expect(board.self(), awaited);
        bool const posted = core.post(clock, core.source_ns(time), clock.tick());
        for (MemberPlan const& member : plan) {
            if (lockstep::bit_of(clock.awaited(), barrier.member_index(member.name))) {
                board.ring(board.place_of(member.name));
            }
        }
        return posted;
    }

    /// Waits under the deadline of the start for everybody to be READY.
    Result<void> await_ready(std::string const& what) {
        StartPatience patience{core.config.clock.start_timeout_s};
        while (true) {
            std::string own_missing = core.refresh_status(MEMBER_STARTING);
            std::unique_lock lock{core.mutex};
            for (Peer const& peer :
                 core.status_matched) { // what is sent to the old incarnation is lost for the new one
                auto const newest = incarnations.find(peer.process);
                if (newest != incarnations.end() && peer.incarnation < newest->second) {
                    own_missing += fmt::format("{}the restarted {}", own_missing.empty() ? "" : ", ", peer.process);
                }
            }
            if (core.error) {
                return std::unexpected{*core.error};
            }
            if (core.stop_requested) {
                return fail(ExitCode::interrupted, fmt::format("stopped while waiting for {}", what));
            }
            std::string const others = not_ready();
            if (own_missing.empty() && others.empty()) {
                return {};
            }
            if (patience.over(core.endpoints_present + others_present())) {
                return fail(ExitCode::stall,
                            fmt::format("{}: not everybody is ready, and nothing has advanced for {} s: {}", what,
                                        shortest(core.config.clock.start_timeout_s),
                                        others.empty() ? "the simulator waits for " + own_missing : others));
            }
            core.changed.wait_for(lock, std::chrono::milliseconds{100});
        }
    }
};

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
            bool const has_sent = std::any_of(ack.wires().begin(), ack.wires().end(),
                                              [](WireLedgerEntry const& entry) { return !entry.frames().empty(); });
            if (member != lockstep::Barrier::kUnknown &&
                !s.barrier.on_ack(member, ack.tick(), ack.next_tick_needed(), has_sent)) {
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
        if (core.lockstep()) {
            s.barrier.open(number, number == 0 || final);
            s.clock.awaited() = s.barrier.awaited_bits();
        }
    }
    if (core.lockstep() && !s.barrier.anybody_awaited()) {
        return {}; // nobody needs to hear of this tick
    }
    if (!core.lockstep()) {
        // Nobody waits for it, and each sample wakes every process: a hundred a second are enough.
        constexpr std::chrono::milliseconds kPeriod{10};
        auto const now = std::chrono::steady_clock::now();
        if (number > 0 && !final && now - s.sent_at < kPeriod) {
            core.together.emplace(); // what the next tick publishes leaves together
            return {};
        }
        s.sent_at = now;
    }
    s.clock.tick(number);
    s.clock.time_ns(core.base.nanoseconds(time));
    s.clock.quanta(time.quanta);
    s.clock.state(final ? CLOCK_FINAL : CLOCK_RUNNING);
    core.fill_ledger(s.clock.ledger());
    bool accepted = true;
    if (core.board != nullptr) {
        core.together.reset(); // all data of the tick is sent before the clock
        accepted = s.post_clock(time);
    }
    if (core.board == nullptr || core.show_to_others(final)) {
        accepted =
            s.clock_writer->write(&s.clock, core.lockstep() ? std::optional{core.source_ns(time)} : std::nullopt) &&
            accepted;
    }
    core.together.reset();
    if (!accepted) {
        return fail(ExitCode::stall, fmt::format("DDS refused clock sample {}", number));
    }
    if (!core.lockstep()) {
        if (final) { // nobody waits in real time, but the end is for all: who has not heard it takes us for dead
            Deadline const patience{2};
            (void)s.clock_writer->wait_acknowledged(patience.left());
            for (Node::Core::WriterSlot const& writer : core.writers) { // what was said last goes with its writer
                if (writer.raw != nullptr && !patience.passed()) {
                    (void)writer.raw->wait_acknowledged(patience.left());
                }
            }
            return {};
        }
        core.together.emplace(); // what the next tick publishes leaves with its clock, in few datagrams
        return {};
    }
    std::unique_lock lock{core.mutex};
    auto const may_go_on = [&] {
        return core.error || core.stop_requested || (s.barrier.complete() && s.inputs_complete());
    };
    double const patience_s = core.config.clock.member_timeout_s;
    bool in_time = true;
    std::chrono::duration<double> look = WaitedTime::kLook;
    Receiving::Turn turn{Receiving::of_process()};
    for (WaitedTime waited; in_time && !may_go_on();) {
        if (patience_s > 0) {
            look = std::min(look, std::chrono::duration<double>{patience_s} - waited.look());
        }
        core.wait_for_more(turn, lock, std::chrono::duration_cast<std::chrono::nanoseconds>(look),
                           s.barrier.complete());
        in_time = patience_s <= 0 || waited.look().count() < patience_s;
    }
    if (!in_time) { // where everything was paused, this process may be the first that runs again
        for (auto const until = std::chrono::steady_clock::now() + std::chrono::milliseconds{200};
             !may_go_on() && std::chrono::steady_clock::now() < until;) {
            core.wait_for_more(turn, lock, std::chrono::milliseconds{50}, s.barrier.complete());
        }
        in_time = may_go_on();
    }
    if (core.error) {
        return std::unexpected{*core.error};
    }
    if (!in_time) {
        return fail(ExitCode::stall,
                    fmt::format("tick {} ({} s): waited {} s for {}", number, shortest(core.base.seconds(time)),
                                shortest(core.config.clock.member_timeout_s), s.culprits()));
    }
    for (auto& reader : core.readers) {
        // Everything that was sent up to this tick is here; its effect may lie in the future.
        reader->inbox->release({INT64_MAX});
    }
    if (!final) {
        core.together.emplace(); // until the next clock
    } else {
        core.leave_at_once_unless_watched();
    }
    return {};
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
