// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A node's life on the clock: next, done. Its start is in node_start.cpp, endpoints are in node.cpp, receiving is in
// node_receive.cpp.
#include "bus/deadline.hpp"
#include "bus/effect_time.hpp"
#include "bus/node.hpp"
#include "bus/node_core.hpp"
#include "common/log.hpp"
#include "common/text.hpp"
#include "common/waited_time.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>
#include <thread>
#include <utility>

namespace gridspace::bus {

/// The wait of next() in lockstep. Waiting for the next clock may take any time: others work, or the run is paused.
/// Once the clock has come, what belongs to it must follow: twice the simulator's own patience, so that it can name the
/// culprit first.
struct Node::Core::TickWait {
    Core& core;
    std::unique_lock<std::mutex>& lock;
    double patience_s{2 * core.config.clock.member_timeout_s};
    std::chrono::steady_clock::time_point pending_since{core.pending_since};
    bool said{false}; ///< why it waits
    WaitedTime waiting{};
    Receiving::Turn turn{Receiving::of_process()};

    [[nodiscard]] bool over() const {
        return core.error || core.stop_requested || core.final_done || core.gate->granted().has_value();
    }
    void wait() {
        while (!over()) {
            if (!core.fetch_frames.empty() && core.gate->lacks_only_frames()) {
                if (fetch_frames()) {
                    return;
                }
            } else {
                wait_for_more();
            }
            refresh();
            watch_patience();
        }
    }
    /// What was reported as missing is there.
    void take_back() {
        if (said) {
            unlocked([&] { core.publish_status(MEMBER_READY, ""); });
        }
    }

  private:
    template <class Work>
    void unlocked(Work const& work) {
        lock.unlock();
        work();
        lock.lock();
    }
    bool fetch_frames() {
        unlocked([&] { std::ranges::for_each(core.fetch_frames, [](auto const& fetch) { fetch(); }); });
        if (over()) {
            return true;
        }
        constexpr std::chrono::microseconds kOnTheirWay{200}; // the kernel has them already, somewhere
        turn.wait(lock, core.changed, kOnTheirWay);
        return false;
    }
    void wait_for_more() {
        core.wait_for_more(turn, lock, WaitedTime::kLook, core.gate->lacks_only_samples());
        if (core.board == nullptr && core.may_sleep()) {
            unlocked([round = core.round] { std::this_thread::sleep_for(round); });
        }
    }
    /// What others have to hear meanwhile.
    void refresh() {
        if (core.matches_published != core.matches_generation) {
            unlocked([&] { core.refresh_status(MEMBER_READY); });
        }
        if (std::exchange(core.restate_ledger, false)) {
            unlocked([&, tick = core.clock.tick(), time = core.latest_time] { (void)core.acknowledge(tick, 0, time); });
        }
    }
    void watch_patience() {
        if (std::exchange(pending_since, core.pending_since) != core.pending_since || !core.gate->has_pending()) {
            waiting.restart();
        }
        auto const waited = waiting.look();
        auto const lasts = [&](double share) {
            return patience_s > 0 && core.gate->has_pending() && waited.count() > share * patience_s && !over();
        };
        if (!said && lasts(0.25)) {
            said = true; // the simulator is to know why, when its own patience is over
            unlocked([&, awaited = core.gate->awaiting()] { core.publish_status(MEMBER_READY, awaited); });
        }
        if (lasts(1)) {
            core.fail_locked({ExitCode::stall,
                              fmt::format("tick {}: waited {} s for {}", core.clock.tick(), shortest(patience_s),
                                          core.gate->awaiting()),
                              ""});
        }
    }
};

Result<std::optional<Tick>> Node::next(std::optional<std::chrono::steady_clock::time_point> deadline) {
    std::unique_lock lock{core_->mutex};
    return core_->lockstep() ? core_->next_in_lockstep(lock) : core_->next_in_real_time(lock, deadline);
}

Result<std::optional<Tick>> Node::Core::next_in_lockstep(std::unique_lock<std::mutex>& lock) {
    TickWait awaited{*this, lock};
    awaited.wait();
    if (error) {
        return std::unexpected{*error};
    }
    if (stop_requested || final_done) {
        return std::nullopt;
    }
    awaited.take_back();
    Tick const tick = next_part(*gate->granted());
    for (auto& reader : readers) {
        reader->inbox->release(tick.time);
    }
    for (auto const& tap : taps) {
        tap->release(tick.time);
    }
    release_wires(tick.time);
    log::set_time(base.seconds(tick.time));
    if (!together) { // until the acknowledgement
        together.emplace();
    }
    return tick;
}

Result<std::optional<Tick>>
Node::Core::next_in_real_time(std::unique_lock<std::mutex>& lock,
                              std::optional<std::chrono::steady_clock::time_point> deadline) {
    auto const anything_new = [&] {
        return error || stop_requested || final_done || clock_generation != clock_taken ||
               input_generation != input_taken;
    };
    if (deadline) {
        changed.wait_until(lock, *deadline, anything_new);
    } else {
        changed.wait(lock, anything_new);
    }
    if (!error && !stop_requested && !final_done) {
        watch_clock();
    }
    if (error) {
        return std::unexpected{*error};
    }
    if (stop_requested || final_done) {
        return std::nullopt;
    }
    clock_taken = clock_generation;
    input_taken = input_generation;
    Tick const tick{clock.tick(), time_now(), clock_seen && clock.state() == CLOCK_FINAL};
    log::set_time(base.seconds(tick.time));
    if (tick.final) {
        lock.unlock();
        publish_status(MEMBER_STOPPING, ""); // the simulator stays until everybody has heard the end
        lock.lock();
    }
    return tick;
}

Tick Node::Core::next_part(lockstep::TickGate::Grant const& grant) {
    SimTime end = latest_time;
    if (beyond.quanta > 0 && !grant.final) {
        end = end + beyond;
        if (config.clock.ends_at_s) { // the end itself is the last tick's alone
            end = std::min(end, SimTime{} + base.nearest(*config.clock.ends_at_s) - SimSpan{1});
        }
    }
    Tick tick{grant.tick, end, grant.final, false};
    if (beyond.quanta > 0) {
        std::int64_t const second = worked_until.quanta < 0 ? 0 : base.seconds_exact(worked_until).floor() + 1;
        SimTime const boundary = SimTime{} + base.nearest(Rational{second});
        if (boundary < end) {
            tick = {grant.tick, boundary, false, true};
        }
    }
    worked_until = tick.time;
    return tick;
}

bool Node::Core::acknowledge(std::uint64_t tick, std::uint64_t next_tick_needed, SimTime time) {
    ack.tick(tick);
    ack.next_tick_needed(next_tick_needed);
    fill_ledger(ack.ledger());
    ack.wires() = wire_writers;
    for (WireLedgerEntry& entry : wire_writers) {
        entry.frames().clear();
    }
    if (board == nullptr || next_tick_needed == 0) {
        return ack_writer->write(&ack, source_ns(time));
    }
    together.reset(); // all data of the tick is sent before the acknowledgement
    bool accepted = post(ack, source_ns(time), tick);
    for (std::size_t const place : board_rung) {
        board->ring(place);
    }
    if (show_to_others(final_done)) {
        accepted = ack_writer->write(&ack, source_ns(time)) && accepted;
    }
    return accepted;
}

Result<void> Node::done(Tick const& tick, std::uint64_t next_tick_needed) {
    Core& core = *core_;
    {
        std::lock_guard const lock{core.mutex};
        if (core.error) {
            return std::unexpected{*core.error};
        }
        if (tick.part) {
            return {};
        }
        if (tick.final) {
            core.final_done = true;
        }
        if (core.lockstep()) {
            core.gate->done();
            core.acknowledged = tick.number;
        }
    }
    if (!core.lockstep()) {
        // What was said last is still on its way, and goes with its writer: leaving waits until it has arrived.
        Deadline const patience{tick.final ? 2.0 : 0};
        for (Core::WriterSlot const& writer : core.writers) {
            if (tick.final && writer.raw != nullptr && !patience.passed()) {
                (void)writer.raw->wait_acknowledged(patience.left());
            }
        }
        return {};
    }
    for (auto const& flush : core.flush_frames) {
        flush();
    }
    bool const accepted = core.acknowledge(tick.number, std::max(next_tick_needed, tick.number + 1), tick.time);
    core.together.reset();
    if (!accepted) {
        return fail(ExitCode::stall, fmt::format("DDS refused the acknowledgement of tick {}", tick.number));
    }
    if (tick.final) {
        // The simulator leaves when everybody has everything. Until then a datagram that was lost on the way to it or
        // to another member is sent again, and who sent it must be here to do so.
        Deadline const patience{5};
        std::unique_lock lock{core.mutex};
        (void)patience.wait(core.changed, lock,
                            [&] { return core.simulator_left || core.error || core.stop_requested; });
        if (core.simulator_left && !core.error) {
            core.leave_at_once_unless_watched();
        }
    }
    return {};
}

void Node::exchange_frames_with(std::function<void()> fetch, std::function<void()> flush) {
    if (fetch) {
        core_->fetch_frames.push_back(std::move(fetch));
    }
    if (flush) {
        core_->flush_frames.push_back(std::move(flush));
    }
}

void Node::listen_in_rounds(std::chrono::microseconds round) {
    core_->round = round;
}

void Node::request_stop() {
    std::lock_guard const lock{core_->mutex};
    core_->stop_requested = true;
    core_->notify();
}

void Node::fail_with(Error error) {
    core_->fail(std::move(error));
}

std::optional<Error> Node::failure() const {
    std::lock_guard const lock{core_->mutex};
    return core_->error;
}

bool Node::stop_is_requested() const {
    std::lock_guard const lock{core_->mutex};
    return core_->stop_requested;
}

std::vector<std::string> Node::writers_here() const {
    Core const& core = *core_;
    ClockConfig const& clock = core.config.clock;
    std::set<std::string> here;
    for (auto const& reader : core.readers) {
        auto const expected = core.config.expected_writers.find(reader->topic);
        if (expected == core.config.expected_writers.end()) {
            continue;
        }
        for (Peer const& peer : reader->raw->matched()) {
            bool const ends_with_the_clock =
                peer.process == clock.simulator ||
                std::find(clock.members.begin(), clock.members.end(), peer.process) != clock.members.end();
            if (ends_with_the_clock && expected->second.contains(peer.process)) {
                here.insert(peer.process);
            }
        }
    }
    return {here.begin(), here.end()};
}

std::string Node::missing_of_simulator() const {
    std::lock_guard const lock{core_->mutex};
    std::size_t const simulator = core_->book->process_index(core_->config.clock.simulator);
    return simulator == lockstep::LedgerBook::kUnknown ? "" : core_->book->missing(simulator);
}

NodeConfig const& Node::config() const {
    return core_->config;
}
TimeBase const& Node::time_base() const {
    return core_->base;
}
bool Node::lockstep() const {
    return core_->lockstep();
}

SimTime Node::latest_time() const {
    std::lock_guard const lock{core_->mutex};
    return core_->time_now();
}

bool Node::clock_runs() const {
    std::lock_guard const lock{core_->mutex};
    auto const& pace = core_->pace;
    return !core_->has_clock() || (core_->clock_seen && (core_->lockstep() || pace.last_arrived != pace.first_arrived));
}

std::int64_t Node::start_unix_ns() const {
    std::lock_guard const lock{core_->mutex};
    return core_->clock_seen ? core_->clock.start_unix_ns() : core_->has_clock() ? 0 : core_->epoch_ns;
}

SimTime Node::effect_time(SimTime input, SimSpan latency) const {
    return bus::effect_time(core_->config.clock.mode, input, latest_time(), core_->tick_span, latency);
}

bool Node::is_of_simulator(std::string const& topic) const {
    auto const writers = core_->config.expected_writers.find(topic);
    return writers != core_->config.expected_writers.end() && writers->second.contains(core_->config.clock.simulator);
}

bool Node::is_over(SimTime t, Tick const& tick) const {
    return lockstep() && t + core_->tick_span <= tick.time;
}

bool Node::has_come(SimTime t) const {
    return lockstep() && t <= latest_time();
}

Node::Counters Node::counters() const {
    std::uint64_t foreign_frames = 0;
    for (ForeignOnLink const& link : foreign_frames_by_link()) {
        foreign_frames += link.frames.total() + link.not_fetched;
    }
    return {core_->foreign_samples.load(), core_->refused_writes.load(), foreign_frames, core_->lost_samples.load()};
}

std::map<std::string, std::uint64_t> Node::impostor_samples() const {
    std::lock_guard const lock{core_->mutex};
    return core_->impostor_samples;
}

std::string Node::refused_datagrams() const {
    std::string const management = core_->management->refused_datagrams();
    std::string const data = core_->data != nullptr ? core_->data->refused_datagrams() : "";
    return management + (management.empty() || data.empty() ? "" : "; on the data network ") + data;
}

std::vector<Node::ForeignOnLink> Node::foreign_frames_by_link() const {
    std::vector<ForeignOnLink> out;
    std::lock_guard const lock{core_->mutex};
    for (auto const& reader : core_->wire_readers) {
        if (core_->lockstep() && core_->wire_book != nullptr) {
            out.push_back(
                {reader->link, reader->ethertype, core_->wire_book->foreign(reader->channel), reader->not_fetched});
        }
    }
    return out;
}

} // namespace gridspace::bus
