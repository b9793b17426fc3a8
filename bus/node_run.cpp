// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A node's life on the clock: start, next, done. Endpoints are in node.cpp, receiving is in node_receive.cpp.
#include "bus/cork.hpp"
#include "bus/deadline.hpp"
#include "bus/effect_time.hpp"
#include "bus/node.hpp"
#include "bus/node_core.hpp"
#include "bus/start_patience.hpp"
#include "bus/topics.hpp"
#include "common/log.hpp"
#include "common/privileges/call_filter.hpp"
#include "common/privileges/capabilities.hpp"
#include "common/text.hpp"
#include "common/waited_time.hpp"

#include <algorithm>
#include <catalog.h>
#include <fmt/format.h>
#include <set>
#include <thread>
#include <utility>

namespace gridspace::bus {
namespace {

/// What is expected of one endpoint, in addition to what the configuration lists.
void expect(ExpectedPeers& peers, char const* topic, std::string const& process) {
    peers[topic].try_emplace(process, 1);
}

/// For each expected process: are so many endpoints of its newest incarnation matched?
void check_matches(std::string_view kind, std::string const& topic, std::map<std::string, std::int64_t> const& expected,
                   std::vector<Peer> const& matched, std::map<std::string, std::uint32_t>& newest,
                   std::set<std::string>& lacking, std::set<std::string> const& absent, Lookout& lookout) {
    std::string& missing = lookout.missing;
    for (auto const& [process, count] : expected) {
        if (absent.contains(process)) {
            continue;
        }
        std::uint32_t incarnation = 0;
        std::int64_t endpoints = 0;
        for (Peer const& peer : matched) {
            if (peer.process != process || peer.incarnation < incarnation) {
                continue;
            }
            endpoints = peer.incarnation > incarnation ? 1 : endpoints + 1;
            incarnation = peer.incarnation;
        }
        lookout.present += static_cast<std::size_t>(std::min(endpoints, count));
        auto const [it, added] = newest.try_emplace(process, incarnation);
        if (endpoints < count) {
            lacking.insert(process);
            std::string const lack =
                fmt::format("{} of {} {}(s) of '{}' in {}", count - endpoints, count, kind, topic, process);
            if (missing.size() < 160 &&
                missing.find(lack) == std::string::npos) { // several writers may lack the same reader
                missing += (missing.empty() ? "" : ", ") + lack;
            }
        } else if (!added) {
            if (it->second != incarnation) { // some endpoints still know the old incarnation only
                lacking.insert(process);
                missing += fmt::format("{}the restarted {}", missing.empty() ? "" : ", ", process);
            }
            it->second = std::max(it->second, incarnation);
        }
    }
}

} // namespace

std::vector<Peer> Node::Core::matched_peers(Lookout& lookout) const {
    std::map<std::string, std::uint32_t> newest;
    std::set<std::string> lacking;
    auto const look = [&](std::string_view kind, ExpectedPeers const& expected, std::string const& topic,
                          std::vector<Peer> const& matched) {
        if (auto const it = expected.find(topic); it != expected.end()) {
            check_matches(kind, topic, it->second, matched, newest, lacking, absent, lookout);
        }
    };
    for (auto const& reader : readers) {
        look("writer", config.expected_writers, reader->topic, reader->raw->matched());
    }
    // Several writers of one topic: each must be matched with every expected reader.
    for (WriterSlot const& writer : writers) {
        if (writer.raw != nullptr) {
            look("reader", config.expected_readers, writer.topic, writer.raw->matched());
        }
    }
    if (clock_reader != nullptr) {
        look("writer", config.expected_writers, "simulation_clock", clock_reader->matched());
    }
    if (ack_reader != nullptr) {
        look("writer", config.expected_writers, "clock_ack", ack_reader->matched());
    }
    if (ack_writer != nullptr) {
        look("reader", config.expected_readers, "clock_ack", ack_writer->matched());
    }
    std::vector<Peer> out;
    for (auto const& [process, incarnation] : newest) {
        if (!lacking.contains(process)) {
            out.push_back({process, incarnation, ""});
        }
    }
    return out;
}

std::string Node::Core::refresh_status(MemberState state_when_incomplete) {
    {
        std::lock_guard const lock{mutex};
        matches_published = matches_generation;
    }
    Lookout lookout;
    std::vector<Peer> const matched = matched_peers(lookout);
    std::string& missing = lookout.missing;
    endpoints_present = lookout.present;
    if (missing.empty() && is_late_joiner()) {
        std::lock_guard const lock{mutex};
        missing = joining ? missing_ledgers() : "";
    }
    MemberState const state = missing.empty() ? MEMBER_READY : state_when_incomplete;
    if (state == MEMBER_READY) {
        std::lock_guard const lock{mutex};
        if (std::exchange(joining, false)) { // before anybody hears of it: the clock may come at once
            for (std::size_t const place : board_heard) {
                if (is_late_joiner()) {
                    board->skip(place);
                }
            }
            settle_rosters();
        }
    }
    if (matched == status_matched && missing == status_missing) {
        return missing;
    }
    status_matched = matched;
    status_missing = missing;
    publish_status(state, missing);
    return missing;
}

void Node::Core::publish_status(MemberState state, std::string_view waiting_for) {
    MemberStatus status;
    status.process(config.process.c_str());
    status.incarnation(static_cast<std::uint32_t>(config.incarnation));
    status.state(state);
    for (Peer const& peer : status_matched) {
        MatchedPeer entry;
        entry.process(peer.process.c_str());
        entry.incarnation(peer.incarnation);
        status.matched().push_back(entry);
    }
    status.waiting_for(std::string{waiting_for.substr(0, 255)}.c_str());
    status_writer->write(&status, std::nullopt);
}

Result<void> Node::start() {
    Core& core = *core_;
    NodeConfig& config = core.config;
    ClockConfig const& clock = config.clock;
    if (config.is_daemon && !may_open_raw_sockets()) {
        (void)forbid_raw_sockets();
    }

    if (auto ok = core.join_board(); !ok) {
        return ok;
    }
    std::vector<std::string> processes = clock.members;
    processes.push_back(clock.simulator);
    for (auto const& [topic, peers] : config.expected_writers) {
        for (auto const& [process, count] : peers) {
            processes.push_back(process);
        }
    }
    std::sort(processes.begin(), processes.end());
    processes.erase(std::unique(processes.begin(), processes.end()), processes.end());
    std::vector<std::string> topics;
    for (auto const& reader : core.readers) {
        topics.push_back(reader->topic);
    }
    core.book = std::make_unique<lockstep::LedgerBook>(processes, topics);
    std::vector<lockstep::WireBook::Channel> channels;
    for (auto const& reader : core.wire_readers) {
        reader->channel = channels.size();
        channels.push_back({reader->link, reader->ethertype});
    }
    {
        std::lock_guard const lock{core.mutex}; // frames arrive already
        core.wire_book = std::make_unique<lockstep::WireBook>(processes.size(), channels);
    }
    core.gate = std::make_unique<lockstep::TickGate>(
        lockstep::TickGate::Config{config.process, clock.simulator, clock.members, clock.upstream, clock.late_upstream},
        *core.book, core.wire_book.get());
    core.ack.member(config.process.c_str());
    core.ack.incarnation(static_cast<std::uint32_t>(config.incarnation));

    // The clock's own endpoints, and what they are to be matched with.
    Participant& management = *core.management;
    if (!core.is_simulator() && core.has_clock()) {
        expect(config.expected_writers, "simulation_clock", clock.simulator);
        auto reader =
            management.create_reader("simulation_clock", codec_of<SimClock>(),
                                     [&core](auto cdr, auto const& header) { core.on_clock_sample(cdr, header); });
        if (!reader) {
            return std::unexpected{reader.error()};
        }
        core.clock_reader = std::move(*reader);
    }
    if (core.lockstep()) {
        std::vector<std::string> const& heard = core.is_simulator() ? clock.members : clock.upstream;
        if (!heard.empty()) {
            for (std::string const& process : heard) {
                expect(config.expected_writers, "clock_ack", process);
            }
            auto reader =
                management.create_reader("clock_ack", codec_of<ClockAck>(),
                                         [&core](auto cdr, auto const& header) { core.on_ack_sample(cdr, header); });
            if (!reader) {
                return std::unexpected{reader.error()};
            }
            core.ack_reader = std::move(*reader);
        }
        if (!core.is_simulator()) {
            expect(config.expected_readers, "clock_ack", clock.simulator);
            for (std::string const& process : clock.downstream) {
                expect(config.expected_readers, "clock_ack", process);
            }
        }
    }
    for (auto& slot : core.readers) {
        slot->book_reader = static_cast<std::size_t>(&slot - core.readers.data());
        auto* raw_slot = slot.get();
        Participant& network = core.network_of(slot->topic);
        slot->network = &network;
        auto reader = network.create_reader(slot->topic, slot->codec, [&core, raw_slot](auto cdr, auto const& header) {
            core.on_data_sample(*raw_slot, cdr, header);
        });
        if (!reader) {
            return std::unexpected{reader.error()};
        }
        slot->raw = std::move(*reader);
    }

    std::sort(core.catalogued_types.begin(), core.catalogued_types.end());
    core.catalogued_types.erase(std::unique(core.catalogued_types.begin(), core.catalogued_types.end()),
                                core.catalogued_types.end());
    for (std::string const& type : core.catalogued_types) {
        if (std::string_view const idl = idl_of_type(type); !idl.empty()) {
            TypeCatalogEntry entry;
            entry.type_name(type.c_str());
            entry.idl(std::string{idl});
            core.catalog_writer->write(&entry, std::nullopt);
        }
    }

    // Twice the simulator's own patience, so that it can name the culprit while the others are still there.
    double const patience_s = (core.is_simulator() || !core.has_clock() ? 1 : 2) * clock.start_timeout_s;
    StartPatience patience{patience_s};
    auto const began = std::chrono::steady_clock::now();
    bool said = false;
    while (true) {
        std::string const missing = core.refresh_status(MEMBER_STARTING);
        bool const ready = missing.empty();
        if (core.has_namesake()) {
            return fail(ExitCode::environment, fmt::format("another '{}' is already on this bus", config.process),
                        "two programs of one name in a run (a service, and a start by hand?), or another run on this "
                        "network and DDS domain");
        }
        std::unique_lock lock{core.mutex};
        if (ready) {
            return core.error ? Result<void>{std::unexpected{*core.error}} : Result<void>{};
        }
        if (core.error) {
            return std::unexpected{*core.error};
        }
        if (core.stop_requested) {
            return fail(ExitCode::interrupted, "stopped while waiting for the others");
        }
        if (patience.over(core.endpoints_present + (core.others_present ? core.others_present() : 0))) {
            std::string const who = core.who_is_missing ? core.who_is_missing() : "";
            return fail(ExitCode::stall,
                        fmt::format("not ready, and nothing has advanced for {} s: {}", shortest(patience_s),
                                    who.empty() ? "still unmatched " + missing : who),
                        "is that process running, and on the same network and DDS domain?");
        }
        if (!said && std::chrono::steady_clock::now() - began > std::chrono::seconds{3}) {
            said = true;
            log::info("waits for {}", missing);
        }
        // Discovery callbacks notify; the short period only covers a change between the look and the wait.
        core.changed.wait_for(lock, std::chrono::milliseconds{100});
    }
}

Result<std::optional<Tick>> Node::next(std::optional<std::chrono::steady_clock::time_point> deadline) {
    Core& core = *core_;
    std::unique_lock lock{core.mutex};
    if (core.lockstep()) {
        auto const may_return = [&] {
            return core.error || core.stop_requested || core.final_done || core.gate->granted().has_value();
        };
        // Waiting for the next clock may take any time: others work, or the run is paused. Once the clock has come,
        // what belongs to it must follow: twice the simulator's own patience, so that it can name the culprit first.
        double const patience_s = 2 * core.config.clock.member_timeout_s;
        bool said = false;
        auto pending_since = core.pending_since;
        WaitedTime waiting;
        Receiving::Turn turn{Receiving::of_process()};
        while (!may_return()) {
            if (!core.fetch_frames.empty() && core.gate->lacks_only_frames()) {
                lock.unlock();
                for (auto const& fetch : core.fetch_frames) {
                    fetch();
                }
                lock.lock();
                if (may_return()) {
                    break;
                }
                constexpr std::chrono::microseconds kOnTheirWay{200}; // the kernel has them already, somewhere
                turn.wait(lock, core.changed, kOnTheirWay);
            } else {
                core.wait_for_more(turn, lock, WaitedTime::kLook, core.gate->lacks_only_samples());
                if (core.board == nullptr && core.may_sleep()) {
                    auto const round = core.round;
                    lock.unlock();
                    std::this_thread::sleep_for(round);
                    lock.lock();
                }
            }
            if (core.matches_published != core.matches_generation) {
                lock.unlock();
                core.refresh_status(MEMBER_READY);
                lock.lock();
            }
            if (core.restate_ledger) {
                core.restate_ledger = false;
                std::uint64_t const tick = core.clock.tick();
                SimTime const time = core.latest_time;
                lock.unlock();
                (void)core.acknowledge(tick, 0, time);
                lock.lock();
            }
            if (std::exchange(pending_since, core.pending_since) != core.pending_since || !core.gate->has_pending()) {
                waiting.restart();
            }
            auto const waited = waiting.look();
            if (patience_s > 0 && core.gate->has_pending() && waited.count() > patience_s / 4 && !said &&
                !may_return()) {
                said = true; // the simulator is to know why, when its own patience is over
                std::string const awaited = core.gate->awaiting();
                lock.unlock();
                core.publish_status(MEMBER_READY, awaited);
                lock.lock();
            }
            if (patience_s > 0 && core.gate->has_pending() && waited.count() > patience_s && !may_return()) {
                core.fail_locked({ExitCode::stall,
                                  fmt::format("tick {}: waited {} s for {}", core.clock.tick(), shortest(patience_s),
                                              core.gate->awaiting()),
                                  ""});
            }
        }
        if (core.error) {
            return std::unexpected{*core.error};
        }
        if (core.stop_requested || core.final_done) {
            return std::nullopt;
        }
        if (said) {
            lock.unlock();
            core.publish_status(MEMBER_READY, "");
            lock.lock();
        }
        Tick const tick = core.next_part(*core.gate->granted());
        for (auto& reader : core.readers) {
            reader->inbox->release(tick.time);
        }
        for (auto const& tap : core.taps) {
            tap->release(tick.time);
        }
        core.release_wires(tick.time);
        log::set_time(core.base.seconds(tick.time));
        cork(); // until the acknowledgement
        return tick;
    }
    auto const anything_new = [&] {
        return core.error || core.stop_requested || core.final_done || core.clock_generation != core.clock_taken ||
               core.input_generation != core.input_taken;
    };
    if (deadline) {
        core.changed.wait_until(lock, *deadline, anything_new);
    } else {
        core.changed.wait(lock, anything_new);
    }
    if (core.error) {
        return std::unexpected{*core.error};
    }
    if (core.stop_requested || core.final_done) {
        return std::nullopt;
    }
    core.watch_clock();
    if (core.error) {
        return std::unexpected{*core.error};
    }
    core.clock_taken = core.clock_generation;
    core.input_taken = core.input_generation;
    Tick const tick{core.clock.tick(), core.time_now(), core.clock_seen && core.clock.state() == CLOCK_FINAL};
    log::set_time(core.base.seconds(tick.time));
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
    uncork(); // what belongs to the tick is on its way before anybody is told
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
    uncork();
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
