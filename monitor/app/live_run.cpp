// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/live_run.hpp"

#include "bus/codec.hpp"
#include "bus/topics.hpp"
#include "common/idl/cdr_visitor.hpp"
#include "common/log.hpp"

#include <algorithm>
#include <catalog.h>
#include <clock.h>
#include <fmt/format.h>
#include <protection.h>
#include <signals.h>
#include <statistics.h>
#include <utility>

namespace gridspace::monitor {
namespace {

constexpr std::size_t kKeptSamples = 64;
constexpr std::size_t kKeptOctets = 256 * 1024;     ///< per topic, of several samples
constexpr std::size_t kAllLargeOctets = 64U << 20U; ///< of all topics, where a sample has more than that
constexpr std::size_t kCheckedOctets = 64 * 1024;   ///< of a sample: a larger one would take too long
constexpr std::size_t kKeptEvents = 10'000;
constexpr std::size_t kGroups = 256;
constexpr std::size_t kStreamEnds = 4096;
constexpr std::size_t kTypes = 4096;
constexpr std::size_t kMaxReported = 1024;
constexpr std::size_t kProcesses = 4096;         ///< that acknowledge
constexpr std::size_t kWindowValues = 4'000'000; ///< of one group and level: 16 MB, 32 MB in the coarser ones

StreamEnd end_of(StreamStatistics const& sample) {
    StreamEnd out;
    out.sends = sample.direction() == STREAM_SENT;
    out.state = sample.state() == STREAM_WAITING ? "waiting" : sample.state() == STREAM_ALIVE ? "alive" : "lost";
    out.frames = sample.frames();
    out.lost = sample.lost();
    out.duplicate = sample.duplicate();
    out.late = sample.late();
    out.refused = sample.refused();
    out.silences = sample.silences();
    out.dropped = sample.dropped();
    out.time_s = static_cast<double>(sample.time_ns()) * 1e-9;
    out.rate_hz = sample.rate_hz();
    return out;
}

/// How many rows a window of so many columns may keep.
std::size_t rows_for(std::size_t columns) {
    return std::clamp<std::size_t>(kWindowValues / std::max<std::size_t>(columns, 1), 1024, 65536);
}

/// Whether a sample is not what IDL text says of its type, as far as that can be known.
bool contradicts(std::string const& text, std::string const& type, std::span<std::byte const> cdr) {
    struct : idl::Visitor {
        void leaf(std::string_view, idl::Type const&, idl::Value const&) override {}
    } nobody;
    auto const model = idl::parse(text, idl::Unsupported::kept);
    auto const index = model ? model->find(type) : std::nullopt;
    return index && model->types[*index].unsupported.empty() && !idl::visit(*model, *index, cdr, nobody);
}

} // namespace

LiveRun::LiveRun(RunPlan run_plan) : plan{std::move(run_plan)} {
    for (RunPlan::Process const& process : plan.processes) {
        graph::Process expected;
        expected.name = process.name;
        expected.program = process.program;
        expected.host = process.host;
        graph.expect(std::move(expected));
    }
    for (RunPlan::Wire const& wire : plan.wires) {
        graph.wire({wire.process, wire.stream, wire.kind, wire.link, wire.sends});
    }
}

void LiveRun::on_sample(std::string const& network, std::string const& topic, std::string const& type,
                        std::string process, std::span<std::byte const> cdr, std::int64_t source_ns) {
    std::lock_guard const lock{mutex};
    TopicState& state = topics[{network, topic}];
    if (state.topic.empty()) {
        state.network = network;
        state.topic = topic;
        state.type = type;
    } else if (state.type != type) { // another program writes it now
        state.type = type;
        newest_octets_ -= std::exchange(state.newest_octets, 0);
        state.newest.clear();
    }
    ++state.samples;
    state.octets += cdr.size();
    decode(topic, type, process, cdr);
    // The newest is always kept, while there is room for large ones.
    if (cdr.size() > kKeptOctets && newest_octets_ - state.newest_octets + cdr.size() > kAllLargeOctets) {
        tell_once("limit", fmt::format("samples of '{}' are too large to be kept beside those of other topics: only "
                                       "their number is shown",
                                       topic));
        return;
    }
    RawSample sample;
    while (!state.newest.empty() &&
           (state.newest.size() >= kKeptSamples || state.newest_octets + cdr.size() > kKeptOctets)) {
        sample = std::move(state.newest.front()); // its memory is used again
        state.newest_octets -= sample.cdr.size();
        newest_octets_ -= sample.cdr.size();
        state.newest.pop_front();
    }
    if (sample.cdr.capacity() > kKeptOctets) {
        sample.cdr = {}; // a small one would hold the memory of a large one
    }
    sample.cdr.assign(cdr.begin(), cdr.end());
    state.newest_octets += cdr.size();
    newest_octets_ += cdr.size();
    sample.process = std::move(process);
    sample.source_ns = source_ns;
    sample.number = state.samples;
    state.newest.push_back(std::move(sample));
}

/// Ticks that nobody needs are not published: time has also come as far as somebody has worked.
void LiveRun::reach(std::int64_t time_ns, std::uint64_t tick) {
    if (recorded || clock.state == "running") {
        clock.time_s = std::max(clock.time_s, static_cast<double>(time_ns) * 1e-9);
        clock.tick = std::max(clock.tick, tick);
    }
}

void LiveRun::decode(std::string const& topic, std::string const& type, std::string const& process,
                     std::span<std::byte const> cdr) {
    bool const good = topic == "simulation_clock"    ? take_clock(process, cdr)
                      : topic == "clock_ack"         ? take_acknowledgement(process, cdr)
                      : topic == "type_catalog"      ? take_type(cdr)
                      : topic == "signal_catalog"    ? take_columns(cdr)
                      : topic == "signals"           ? take_signals(cdr)
                      : topic == "stream_statistics" ? take_stream_end(cdr)
                      : type == "IdsVerdict"         ? intrusion_.on_verdict(cdr, signals)
                      : type == "AttackLabel"        ? intrusion_.on_label(cdr)
                                                     : true;
    undecodable += good ? 0 : 1;
}

bool LiveRun::take_clock(std::string const& process, std::span<std::byte const> cdr) {
    SimClock sample;
    if (!bus::codec_of<SimClock>().decode(cdr, &sample)) {
        return false;
    }
    clock.seen = true;
    clock.tick = std::max(clock.tick, sample.tick());
    clock.time_s = std::max(clock.time_s, static_cast<double>(sample.time_ns()) * 1e-9);
    clock_process_ = process;
    if (!recorded) {
        clock.state = sample.state() == CLOCK_FINAL ? "final" : sample.state() == CLOCK_ABORTED ? "aborted" : "running";
    }
    return true;
}

bool LiveRun::take_acknowledgement(std::string const& process, std::span<std::byte const> cdr) {
    ClockAck sample;
    if (!bus::codec_of<ClockAck>().decode(cdr, &sample)) {
        return false;
    }
    if (acknowledged.size() < kProcesses || acknowledged.contains(process)) {
        acknowledged[process] = {sample.tick(), sample.incarnation()};
    } else {
        full("processes that acknowledge", kProcesses);
    }
    reach(0, sample.tick());
    return true;
}

bool LiveRun::take_type(std::span<std::byte const> cdr) {
    TypeCatalogEntry sample;
    if (!bus::codec_of<TypeCatalogEntry>().decode(cdr, &sample)) {
        return false;
    }
    std::string const name = sample.type_name().c_str();
    auto const known = idl.find(name);
    std::size_t others = 0; // also what a configuration or a recording has put there
    for (auto const& [type, text] : idl) {
        others += type == name ? 0 : text.size();
    }
    if (known == idl.end() && idl.size() >= kTypes) {
        full("types", kTypes);
    } else if (sample.idl().size() > bus::kLongestIdl || others + sample.idl().size() > bus::kMostIdl) {
        tell_once("limit", fmt::format("the IDL of type '{}' is not kept: {} octets, beside {} of other types", name,
                                       sample.idl().size(), others));
    } else {
        idl.insert_or_assign(name, sample.idl());
    }
    return true;
}

bool LiveRun::take_columns(std::span<std::byte const> cdr) {
    SignalCatalog sample;
    if (!bus::codec_of<SignalCatalog>().decode(cdr, &sample)) {
        return false;
    }
    std::vector<stream::SignalWindow::Column> columns;
    for (auto const& column : sample.columns()) {
        columns.push_back({column.name().c_str(), column.unit().c_str(), sample.rate_hz() == 0});
    }
    std::pair<std::string, std::string> const key{sample.source().c_str(), sample.group().c_str()};
    auto const known = signals.find(key);
    bool const same =
        known != signals.end() &&
        std::equal(columns.begin(), columns.end(), known->second->columns().begin(), known->second->columns().end(),
                   [](auto const& a, auto const& b) { return a.name == b.name; });
    if (known == signals.end() && signals.size() >= kGroups) {
        full("groups of signals", kGroups);
    } else if (!same) {
        std::size_t const rows = rows_for(columns.size());
        auto& window = signals[key];
        *values_left_ += window == nullptr ? 0 : window->taken();
        window = std::make_unique<stream::SignalWindow>(std::move(columns), rows, values_left_);
    }
    return true;
}

bool LiveRun::take_stream_end(std::span<std::byte const> cdr) {
    StreamStatistics sample;
    if (!bus::codec_of<StreamStatistics>().decode(cdr, &sample)) {
        return false;
    }
    std::pair<std::string, std::string> key{sample.stream().c_str(), sample.process().c_str()};
    if (stream_ends.contains(key) || stream_ends.size() < kStreamEnds) {
        stream_ends.insert_or_assign(std::move(key), end_of(sample));
    } else {
        full("ends of streams", kStreamEnds);
    }
    return true;
}

bool LiveRun::take_signals(std::span<std::byte const> cdr) {
    SignalFrame sample;
    if (!bus::codec_of<SignalFrame>().decode(cdr, &sample)) {
        return false;
    }
    auto const it = signals.find({sample.source().c_str(), sample.group().c_str()});
    if (it == signals.end() || it->second == nullptr) {
        return true;
    }
    std::size_t const width = it->second->columns().size();
    auto const& times = sample.times_ns();
    auto const& values = sample.values();
    for (std::size_t row = 0; row < times.size() && (row + 1) * width <= values.size(); ++row) {
        it->second->append(times[row], std::span<double const>{values.data() + row * width, width});
    }
    if (!times.empty() && clock_process_ == sample.source().c_str()) {
        reach(times.back(), 0);
    }
    return true;
}

void LiveRun::measure(std::chrono::duration<double> since_last) {
    double const s = since_last.count();
    if (s <= 0) {
        return;
    }
    std::lock_guard const lock{mutex};
    for (auto& [key, state] : topics) {
        state.per_second = static_cast<double>(state.samples - state.samples_then) / s;
        state.samples_then = state.samples;
        if (state.newest.empty() || state.newest.back().number == state.checked) {
            continue;
        }
        RawSample const& newest = state.newest.back();
        state.checked = newest.number;
        auto const known = bus::find_codec(state.type) == nullptr ? idl.find(state.type) : idl.end();
        if (known != idl.end() && newest.cdr.size() <= kCheckedOctets) {
            undecodable += contradicts(known->second, state.type, newest.cdr) ? 1 : 0;
        }
    }
    clock.factor = clock.state == "running" ? std::max(0.0, clock.time_s - time_then_s_) / s : 0;
    time_then_s_ = clock.time_s;
}

graph::Snapshot const& LiveRun::snapshot() const {
    if (recorded_graph) {
        return *recorded_graph;
    }
    if (!snapshot_ || snapshot_->revision != graph.revision()) { // it is asked for often and changes seldom
        snapshot_ = graph.snapshot();
    }
    return *snapshot_;
}

void LiveRun::add_event(RunEvent event) {
    event.number = ++events_seen;
    if (event.event == "exit") {
        graph.process_died(event.source);
    } else if (event.source == "launcher" && event.text.ends_with(" killed")) {
        graph.process_died(event.text.substr(0, event.text.find(' ')));
    } else if (event.source == "launcher" && (event.event == "paused" || event.event == "resumed")) {
        clock.paused = event.event == "paused";
    }
    events.push_back(std::move(event));
    if (events.size() > kKeptEvents) {
        events.pop_front();
    }
}

void LiveRun::full(std::string const& what, std::size_t limit) {
    tell_once("limit", fmt::format("there are more than {} {} on the bus: the others are not shown", limit, what));
}

void LiveRun::tell_once(std::string const& event, std::string const& text) {
    if (reported_.size() < kMaxReported && reported_.insert(text).second) {
        log::warning("{}", text);
        add_event({0, clock.time_s, "monitor", event, text});
    }
}

void LiveRun::tell_not_heard() {
    std::lock_guard const lock{mutex};
    std::set<std::string> now;
    for (graph::Topic const& topic : snapshot().topics) {
        for (std::string const& reason : topic.not_heard) {
            now.insert("the monitor hears nothing on '" + topic.name + "' from " + reason);
        }
    }
    for (std::string const& text : now) { // a reader that is just being replaced misses nothing
        if (unheard_.contains(text) && reported_unheard_.size() < kGroups && reported_unheard_.insert(text).second) {
            add_event({0, clock.time_s, "monitor", "not_heard", text});
        }
    }
    unheard_ = std::move(now);
}

std::pair<stream::SignalWindow const*, std::size_t> LiveRun::find_signal(std::string const& name) const {
    for (auto const& [key, window] : signals) {
        if (window != nullptr) {
            if (auto const column = window->find(name)) {
                return {window.get(), *column};
            }
        }
    }
    return {nullptr, 0};
}

} // namespace gridspace::monitor
