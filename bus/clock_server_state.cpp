// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/clock_server_state.hpp"

#include "bus/start_patience.hpp"
#include "common/text.hpp"

#include <fmt/format.h>

namespace gridspace::bus {

void ClockServer::State::on_status(std::span<std::byte const> cdr, SampleHeader const& header) {
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

std::string ClockServer::State::not_ready() const {
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

std::size_t ClockServer::State::others_present() const {
    std::size_t present = 0;
    for (auto const& [process, status] : statuses) {
        present += 1 + status.matched.size() + (status.state == MEMBER_READY ? 1 : 0);
    }
    return present;
}

std::string ClockServer::State::culprits() const {
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

void ClockServer::State::hold(std::string const& process) {
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

void ClockServer::State::find_places() {
    for (MemberPlan const& member : plan) {
        OnBoard on{core.board->place_of(member.name), barrier.member_index(member.name), {}};
        for (std::string const& up : member.upstream) {
            if (std::find(member.late.begin(), member.late.end(), up) == member.late.end()) {
                on.upstream.push_back(barrier.member_index(up));
            }
        }
        on_board.push_back(std::move(on));
    }
}

bool ClockServer::State::post_clock(SimTime time) {
    Board& board = *core.board;
    auto const is_awaited = [this](std::size_t member) { return lockstep::bit_of(clock.awaited(), member); };
    std::int32_t awaited = 0;
    for (OnBoard const& on : on_board) {
        std::int32_t things = INT32_MIN / 2; // of who is not asked, nothing is the last
        if (is_awaited(on.member)) {
            ++awaited;
            things = 1 + static_cast<std::int32_t>(std::ranges::count_if(on.upstream, is_awaited)); // 1: the clock
        }
        board.expect(on.place, things);
    }
    board.expect(board.self(), awaited);
    bool const posted = core.post(clock, core.source_ns(time), clock.tick());
    for (OnBoard const& on : on_board) {
        if (is_awaited(on.member)) {
            board.ring(on.place);
        }
    }
    return posted;
}

Result<void> ClockServer::State::await_ready(std::string const& what) {
    StartPatience patience{core.config.clock.start_timeout_s};
    while (true) {
        std::string own_missing = core.refresh_status(MEMBER_STARTING);
        std::unique_lock lock{core.mutex};
        for (Peer const& peer : core.status_matched) { // what is sent to the old incarnation is lost for the new one
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
        core.wait_for_matches(lock);
    }
}

} // namespace gridspace::bus
