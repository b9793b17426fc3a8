// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/node.hpp"

#include "bus/cork.hpp"
#include "bus/node_core.hpp"
#include "bus/topics.hpp"
#include "common/log.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <catalog.h>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

namespace gridspace::bus {
namespace {

std::int64_t wall_clock_ns() {
    auto const utc = std::chrono::system_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::nanoseconds>(utc).count();
}

} // namespace

Participant& Node::Core::network_of(std::string const& topic) {
    bool const on_management = is_management_topic(topic) ||
                               std::find(config.management_topics.begin(), config.management_topics.end(), topic) !=
                                   config.management_topics.end();
    return on_management || data == nullptr ? *management : *data;
}

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
    told = std::max(told, latest_time + SimSpan{static_cast<std::int64_t>(quanta_per_s * since_s)});
    return told;
}

void Node::Core::watch_clock() {
    std::int64_t const steady_ns =
        std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
            .count();
    if (auto const by = clock_watch.step(wall_clock_ns(), steady_ns)) {
        fail_locked({ExitCode::environment,
                     fmt::format("the clock of this machine was set {} by {:.3f} s", *by > 0 ? "forward" : "back",
                                 std::abs(static_cast<double>(*by)) / 1e9),
                     "in real time frames are stamped and delays measured with it: let chrony or ntpd finish before "
                     "the run; in lockstep no clock is used"});
    }
}

void Node::Core::fail(Error why) {
    std::lock_guard const lock{mutex};
    fail_locked(std::move(why));
}

void Node::Core::fail_locked(Error why) {
    if (!error) {
        error = std::move(why);
    }
    changed.notify_all();
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

void Node::Core::fill_ledger(std::vector<LedgerEntry>& ledger) const {
    std::size_t used = 0;
    for (WriterSlot const& slot : writers) {
        if (slot.diagnostic) {
            continue;
        }
        auto const same = std::find_if(ledger.begin(), ledger.begin() + static_cast<std::ptrdiff_t>(used),
                                       [&](LedgerEntry const& e) { return slot.topic == e.topic().c_str(); });
        if (same != ledger.begin() + static_cast<std::ptrdiff_t>(used)) {
            same->sent(same->sent() + slot.sent);
            continue;
        }
        if (used == ledger.size()) {
            ledger.emplace_back();
            ledger.back().topic(slot.topic.c_str());
        }
        ledger[used++].sent(slot.sent);
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

bool Node::Core::clock_fits(SampleHeader const& header) {
    if (clock.state() == CLOCK_ABORTED) {
        return true; // it may have ended before it began to count
    }
    constexpr std::int64_t kSlackNs = 1000; // the stamps of DDS count in 2^-32 s
    Rational const quantum = config.clock.quantum_s;
    SimTime const now{clock.quanta()};
    std::int64_t const in_ticks = tick_span.quanta * static_cast<std::int64_t>(clock.tick());
    std::int64_t const off_ns = header.source_ns - source_ns(now);
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
    if (writer_of(clock_sources, header).process != config.clock.simulator) {
        ++foreign_samples; // of another run, or of somebody who looks on
        return;
    }
    std::lock_guard const lock{mutex};
    if (!codec_of<SimClock>().decode(cdr, &clock)) {
        fail_locked({ExitCode::environment,
                     "a clock sample cannot be decoded: another version of Gridspace on this domain?", ""});
        return;
    }
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
    if (!lockstep()) {
        auto const wall_ns = wall_clock_ns();
        if (auto const ahead = clock_watch.offset(header.source_ns, wall_ns)) {
            fail_locked({ExitCode::environment,
                         fmt::format("the clock of this machine is {:.3f} s {} that of the simulator's machine",
                                     std::abs(static_cast<double>(*ahead)) / 1e9, *ahead > 0 ? "ahead of" : "behind"),
                         "in real time they have to agree: chrony, ntpd or PTP on both; in lockstep no clock is used"});
        }
    }
    if (lockstep() && !clock_seen && config.incarnation == 0 && clock.tick() > 0 && clock.state() != CLOCK_ABORTED) {
        fail_locked({ExitCode::environment,
                     fmt::format("the run is already under way: its clock is at tick {}", clock.tick()),
                     "in lockstep a program joins before the start, or is restarted by the scenario (`restart:`)"});
        return;
    }
    clock_seen = true;
    if (clock_tap != nullptr && clock.state() != CLOCK_HELD) {
        Origin origin{{clock.quanta()}, 0, header.writer, header.sequence};
        std::size_t const simulator = book->process_index(config.clock.simulator);
        origin.process =
            static_cast<std::uint32_t>(simulator == lockstep::LedgerBook::kUnknown ? book->process_count() : simulator);
        clock_tap->push(cdr, origin, base);
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
        take_ledger(simulator, 0, clock.ledger()); // in real time it only tells what was lost
    }
    if (lockstep()) {
        if (clock.state() == CLOCK_HELD) {
            on_held_clock();
            return;
        }
        if (!joining) {
            gate->on_clock(clock.tick(), clock.awaited(), clock.state() == CLOCK_FINAL);
            pending_since = std::chrono::steady_clock::now();
        }
        if (!gate->granted()) {
            return; // the last thing to arrive wakes the process, once
        }
    }
    changed.notify_all();
}

void Node::Core::on_held_clock() {
    if (joining) {
        if (is_late_joiner() && config.joins_at_s && SimTime{} + base.nearest(*config.joins_at_s) <= latest_time) {
            held = Held{clock.tick(), {clock.awaited().begin(), clock.awaited().end()}};
        }
    } else {
        std::vector<std::string> const& members = config.clock.members; // in the order of names
        auto const self = std::find(members.begin(), members.end(), config.process);
        restate_ledger = self != members.end() &&
                         lockstep::bit_of(clock.awaited(), static_cast<std::size_t>(self - members.begin()));
    }
    changed.notify_all();
}

std::string Node::Core::missing_ledgers() const {
    if (!held) {
        return "the clock of the tick after which it joins";
    }
    std::string out;
    for (std::string const& name : config.clock.upstream) {
        std::vector<std::string> const& members = config.clock.members;
        auto const member = std::find(members.begin(), members.end(), name);
        bool const restates = member != members.end() &&
                              lockstep::bit_of(held->awaited, static_cast<std::size_t>(member - members.begin()));
        auto const newest = ledgers_of.find(name);
        if (restates && (newest == ledgers_of.end() || newest->second < held->tick)) {
            out += (out.empty() ? "the ledger of " : ", ") + name;
        }
    }
    return out;
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
    bool const is_restated = received.next_tick_needed() == 0;
    if (ack_tap != nullptr && !is_restated) {
        ack_tap->push(cdr,
                      {base.from_nanoseconds(header.source_ns - epoch_ns), static_cast<std::uint32_t>(process),
                       header.writer, header.sequence},
                      base);
    }
    take_ledger(process, received.incarnation(), received.ledger());
    take_wire_ledger(process, received);
    if (joining && is_late_joiner()) {
        ledgers_of[received.member().c_str()] = received.tick();
        changed.notify_all();
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
        changed.notify_all();
    }
}

void Node::Core::on_data_sample(ReaderSlot& slot, std::span<std::byte const> cdr, SampleHeader const& header) {
    if (header.source >= slot.sources.size()) {
        slot.sources.resize(header.source + 1);
    }
    ReaderSlot::Source& source = slot.sources[header.source];
    if (!source.known) {
        Peer const peer = slot.network->peer(header.peer);
        source = {true, book->process_index(peer.process), peer.incarnation, peer.process};
        if (lockstep() && source.process != lockstep::LedgerBook::kUnknown && !slot.diagnostic) {
            auto const expected = config.expected_writers.find(slot.topic);
            if (expected != config.expected_writers.end() && !expected->second.contains(peer.process)) {
                fail({ExitCode::usage,
                      fmt::format("{} writes '{}', which the scenario does not say", peer.process, slot.topic),
                      "in lockstep the order of the processes follows from who writes what: add the topic to its "
                      "`writes`"});
            }
        }
    }
    std::size_t const process = source.process;
    Origin origin;
    origin.writer = header.writer;
    origin.sequence = header.sequence;
    if (process == lockstep::LedgerBook::kUnknown) {
        ++foreign_samples;
        if (lockstep()) {
            return; // a run must not depend on who else is on the bus
        }
        origin.process = static_cast<std::uint32_t>(book->process_count());
    } else {
        origin.process = static_cast<std::uint32_t>(process);
    }
    // Counted and stored under one lock: what the ledger calls complete must be there to be taken.
    std::lock_guard const lock{mutex};
    if (joining && config.incarnation > 0) {
        return; // sent before this incarnation was ready: part of the baseline
    }
    origin.time = lockstep() ? base.from_nanoseconds(header.source_ns - epoch_ns) : time_now();
    if (process != lockstep::LedgerBook::kUnknown) {
        using Arrival = lockstep::LedgerBook::Arrival;
        bool const counted = lockstep() && !slot.diagnostic;
        Arrival const arrival = book->arrived(process, source.incarnation, slot.book_reader, header.writer,
                                              header.sequence, counted ? origin.time.quanta : INT64_MAX);
        if (arrival == Arrival::repeated) {
            return;
        }
        if (arrival == Arrival::late) {
            fail_locked(
                {ExitCode::stall,
                 fmt::format("a sample of '{}' from {} came for {} s, which {} had acknowledged without it", slot.topic,
                             source.name, shortest(base.seconds(origin.time)), source.name),
                 "a member writes all that belongs to a tick before it acknowledges it, and counts it in its ledger"});
            return;
        }
        if (arrival == Arrival::gap) {
            ++lost_samples;
            if (lockstep()) {
                fail_locked({ExitCode::stall,
                             fmt::format("a sample of '{}' from {} is lost: number {} came after a gap", slot.topic,
                                         source.name, header.sequence),
                             "the depth of its QoS profile is too small for this tick, or a socket buffer is"});
                return;
            }
        }
    }
    if (!slot.inbox->push(cdr, origin, base)) {
        fail_locked({ExitCode::environment,
                     fmt::format("a sample of '{}' from {} cannot be decoded", slot.topic, source.name),
                     "both sides must be built from the same IDL"});
        return;
    }
    ++input_generation;
    if (!lockstep() ||
        (is_simulator() ? server_waits_no_more && server_waits_no_more() : gate->granted().has_value())) {
        changed.notify_all();
    }
}

Result<std::unique_ptr<Node>> Node::create(NodeConfig config) {
    auto core = std::make_unique<Core>();
    core->config = std::move(config);
    NodeConfig const& c = core->config;
    core->base = TimeBase{c.clock.quantum_s};
    core->absent.insert(c.absent.begin(), c.absent.end());
    core->tick_span = core->base.nearest(c.clock.tick_s);
    core->epoch_ns = c.clock.epoch_unix_s * 1'000'000'000;

    auto const join = [&](char const* profile, NetworkConfig const& network) {
        return Participant::create({c.process, static_cast<std::uint32_t>(c.incarnation), c.program,
                                    static_cast<int>(network.domain), c.qos, profile, network.addresses});
    };
    auto management = join("management", c.management);
    if (!management) {
        return std::unexpected{management.error()};
    }
    core->management = std::move(*management);
    if (c.data) {
        auto data = join("data", *c.data);
        if (!data) {
            return std::unexpected{data.error()};
        }
        core->data = std::move(*data);
    }
    Core* raw = core.get();
    auto const notify = [raw] {
        std::lock_guard const lock{raw->mutex};
        ++raw->matches_generation;
        raw->changed.notify_all();
    };
    core->management->on_change(notify);
    if (core->data) {
        core->data->on_change(notify);
    }
    core->management->on_departure([raw](Peer const& peer, bool clean) {
        bool const is_debugged =
            !clean && raw->config.clock.member_timeout_s == 0; // without deadlines silence is no failure
        if (peer.process == raw->config.clock.simulator && !raw->is_simulator() && !is_debugged) {
            std::lock_guard const lock{raw->mutex};
            raw->simulator_left = true;
            raw->changed.notify_all();
            bool const over = raw->clock_seen && raw->clock.state() == CLOCK_FINAL; // its work may not be done yet
            if (!over && !raw->final_done && !raw->stop_requested) {
                raw->fail_locked({clean ? ExitCode::child_died : ExitCode::stall,
                                  fmt::format("the simulator '{}' {}", peer.process,
                                              clean ? "has left the bus" : "is silent: its lease ran out"),
                                  "its log says why"});
            }
        }
    });
    auto const writer = [&](char const* topic, Codec const& codec, std::unique_ptr<RawWriter>& out) -> Result<void> {
        auto opened = core->management->create_writer(topic, codec);
        if (!opened) {
            return std::unexpected{opened.error()};
        }
        out = std::move(*opened);
        return {};
    };
    if (auto ok = writer("member_status", codec_of<MemberStatus>(), core->status_writer); !ok) {
        return std::unexpected{ok.error()};
    }
    if (auto ok = writer("type_catalog", codec_of<TypeCatalogEntry>(), core->catalog_writer); !ok) {
        return std::unexpected{ok.error()};
    }
    if (core->lockstep() && !core->is_simulator()) {
        if (auto ok = writer("clock_ack", codec_of<ClockAck>(), core->ack_writer); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    return std::unique_ptr<Node>{new Node{std::move(core)}};
}

Node::Node(std::unique_ptr<Core> core) : core_{std::move(core)} {}

Node::~Node() {
    uncork(); // the farewell must not stay behind: others would wait for the lease to run out
    // Endpoints first: their listeners use the core. A graceful end tells the others that this process is gone.
    core_->clock_reader.reset();
    core_->ack_reader.reset();
    for (auto& reader : core_->readers) {
        reader->raw.reset();
    }
    core_->management->on_change({});
    core_->management->on_departure({});
    if (core_->data) {
        core_->data->on_change({});
    }
}

std::weak_ptr<void>& Node::signal_writers() {
    return core_->signal_writers;
}

Result<std::unique_ptr<RawWriter>> Node::open_writer(std::string const& topic, Codec const& codec, std::size_t& slot) {
    auto raw = core_->network_of(topic).create_writer(topic, codec);
    if (!raw) {
        return raw;
    }
    slot = core_->writers.size();
    core_->writers.push_back({topic, is_diagnostic_topic(topic), nullptr, 0});
    core_->catalogued_types.emplace_back(codec.type_name);
    return raw;
}

Result<void> Node::open_reader(std::string const& topic, Codec const& codec, std::shared_ptr<Inbox> inbox) {
    auto slot = std::make_unique<Core::ReaderSlot>();
    slot->topic = topic;
    slot->diagnostic = is_diagnostic_topic(topic);
    slot->codec = codec;
    slot->inbox = std::move(inbox);
    if (!core_->lockstep()) {
        slot->inbox->release({INT64_MAX});
    }
    core_->catalogued_types.emplace_back(codec.type_name);
    core_->readers.push_back(std::move(slot));
    return {};
}

Result<std::shared_ptr<CdrReader>> Node::cdr_reader(std::string const& topic, Codec const& codec) {
    auto reader = std::make_shared<CdrReader>();
    if (auto opened = open_reader(topic, codec, reader); !opened) {
        return std::unexpected{opened.error()};
    }
    return reader;
}

Result<std::unique_ptr<CdrWriter>> Node::cdr_writer(std::string const& topic, Codec const& codec) {
    std::size_t slot = 0;
    auto raw = open_writer(topic, codec, slot);
    if (!raw) {
        return std::unexpected{raw.error()};
    }
    return std::make_unique<CdrWriter>(*core_, std::move(*raw), slot);
}

std::shared_ptr<CdrReader> Node::tap_clock() {
    auto tap = std::make_shared<CdrReader>();
    core_->clock_tap = tap;
    core_->taps.push_back(tap);
    tap->release({lockstep() ? INT64_MIN : INT64_MAX});
    return tap;
}

std::shared_ptr<CdrReader> Node::tap_acknowledgements() {
    auto tap = std::make_shared<CdrReader>();
    core_->ack_tap = tap;
    core_->taps.push_back(tap);
    return tap;
}

std::string Node::process_name(Origin const& origin) const {
    return origin.process < core_->book->process_count() ? core_->book->process_name(origin.process) : "unknown";
}

} // namespace gridspace::bus
