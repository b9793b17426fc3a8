// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/gateway.hpp"

#include "bus/topics.hpp"
#include "common/log.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::gateways {

struct Gateway::Topic {
    std::string name, type;
    std::shared_ptr<bus::CdrReader> reader;
    std::vector<Source*> sources;
    std::vector<bus::Received<bus::CdrSample>> due;
};

/// A sample or a frame, and when it is.
struct Gateway::Event {
    SimTime time;
    Topic const* topic{nullptr}; ///< nullptr: a frame
    std::size_t sample{0};
    bus::WireFrame const* frame{nullptr};
    std::uint16_t ethertype{0};
};

Gateway::Gateway(GatewaySettings const& settings, DaemonRun& run, bus::Node& node, GatewayGuest* guest)
    : settings_{settings}, run_{run}, node_{node}, guest_{guest}, grid_{node.config().clock}, clock_{node} {}
Gateway::~Gateway() = default;

Result<void> Gateway::run() {
    if (auto ok = prepare(); !ok) {
        return ok;
    }
    Moment last;
    while (true) {
        auto const timer = next_timer();
        auto tick =
            node_.lockstep()
                ? node_.next()
                : node_.next(WireClock::wall(std::min(timer.value_or(INT64_MAX), clock_.now() + 1'000'000'000)));
        if (!tick) {
            return std::unexpected{tick.error()};
        }
        if (!*tick) {
            finish(last);
            return {};
        }
        begin(**tick);
        take_input(**tick);
        last = moment_of(**tick);
        run_timers(last.ns);
        if ((*tick)->final) {
            finish(last);
        }
        publish_counters(**tick);
        publish_ages();
        port_->maintain();
        if (auto ok = node_.done(**tick, next_tick_needed(**tick)); !ok) {
            return ok;
        }
    }
}

std::uint64_t Gateway::next_tick_needed(bus::Tick const& tick) const {
    if (!topics_.empty()) {
        return tick.number + 1; // the simulator's samples do not wake anybody
    }
    auto const second = static_cast<std::int64_t>(node_.time_base().seconds(tick.time));
    std::uint64_t const report = grid_.tick_of(SimTime{} + node_.time_base().nearest(Rational{second + 1}));
    auto const timer = next_timer();
    return timer && node_.lockstep() ? std::min(report, grid_.tick_of(clock_.at_or_after(*timer))) : report;
}

void Gateway::finish(Moment at) {
    for (auto const& sink : sinks_) {
        if (!finished_) {
            sink->finish(at);
        }
    }
    finished_ = true;
}

Moment Gateway::moment_of(bus::Tick const& tick) const {
    return {node_.lockstep() ? clock_.of(tick.time) : clock_.now(), tick.time};
}

Result<void> Gateway::prepare() {
    config::Diagnostics diagnostics;
    routes_ = make_routes(settings_.gateway, settings_.wire.streams, bus::idl_of_type, diagnostics);
    if (!diagnostics.ok()) {
        return fail(ExitCode::usage, diagnostics.render());
    }
    WirePort::Ethertypes ethertypes;
    auto const add = [](std::vector<std::uint16_t>& list, streams::Stream const* stream) {
        if (stream != nullptr && std::find(list.begin(), list.end(), stream->ethertype()) == list.end()) {
            list.push_back(stream->ethertype());
        }
    };
    for (Route const& route : routes_) {
        add(ethertypes.send, route.to_stream);
        add(ethertypes.receive, route.from_stream);
    }
    received_ = ethertypes.receive;
    auto port = WirePort::open(node_, settings_.wire, ethertypes);
    if (!port) {
        return std::unexpected{port.error()};
    }
    port_ = std::move(*port);
    context_ = std::make_unique<GatewayContext>(
        GatewayContext{node_, *port_, settings_.wire, WireClock{node_},
                       node_.time_base().ceil(settings_.gateway.latency_us / Rational{1'000'000})});
    auto statistics = StatisticsPublisher::create(node_);
    if (!statistics) {
        return std::unexpected{statistics.error()};
    }
    statistics_ = std::move(*statistics);
    for (Route& route : routes_) {
        if (auto ok = open_route(route); !ok) {
            return ok;
        }
    }
    std::vector<HeldSink*> held;
    for (Sampled const& sampled : sampled_) {
        if (auto* const sink = dynamic_cast<HeldSink*>(sampled.sink); sink != nullptr && !node_.lockstep()) {
            held.push_back(sink);
        }
    }
    if (!held.empty()) {
        auto pacer = SamplePacer::create(settings_.wire, std::move(held));
        if (!pacer) {
            return std::unexpected{pacer.error()};
        }
        pacer_ = std::move(*pacer);
    }
    if (auto ok = open_signals(); !ok) {
        return ok;
    }
    if (auto ok = open_first_line(); !ok) {
        return ok;
    }
    if (guest_ != nullptr) {
        if (auto ok = guest_->prepare(node_, sources_); !ok) {
            return ok;
        }
    }
    return node_.start();
}

Result<void> Gateway::open_route(Route& route) {
    auto sink = open_sink(route);
    if (!sink) {
        return std::unexpected{sink.error()};
    }
    if (route.from_stream == nullptr) {
        sources_.push_back(make_topic_source(route, **sink));
    } else if (route.from_stream->kind == streams::Kind::smv) {
        sources_.push_back(make_sv_source(route, **sink, node_.lockstep()));
    } else {
        sources_.push_back(make_goose_source(route, **sink, clock_));
    }
    streams::Stream const& stream = route.from_stream != nullptr ? *route.from_stream : *route.to_stream;
    rows_.push_back(&statistics_->add(stream.name.name, route.from_stream != nullptr ? STREAM_RECEIVED : STREAM_SENT));
    return route.from_stream == nullptr ? open_reader(route, *sources_.back()) : Result<void>{};
}

Result<Sink*> Gateway::open_sink(Route& route) {
    if (route.to_stream == nullptr) {
        auto writer = writer_of(route);
        if (!writer) {
            return std::unexpected{writer.error()};
        }
        sinks_.push_back(make_topic_sink(*context_, route, **writer));
        return sinks_.back().get();
    }
    if (route.to_stream->kind == streams::Kind::goose) {
        auto sink = make_goose_sink(*context_, route);
        if (!sink) {
            return std::unexpected{sink.error()};
        }
        sinks_.push_back(std::move(*sink));
        return sinks_.back().get();
    }
    std::unique_ptr<SampleSink> sampled;
    if (route.is_held()) {
        auto sink = HeldSink::create(*context_, route);
        if (!sink) {
            return std::unexpected{sink.error()};
        }
        sampled = std::move(*sink);
    } else {
        auto sink = IndexedSink::create(*context_, route);
        if (!sink) {
            return std::unexpected{sink.error()};
        }
        sampled = std::move(*sink);
    }
    sampled_.push_back({sampled.get(), nullptr});
    sinks_.push_back(std::move(sampled));
    return sinks_.back().get();
}

/// A type that the program was not compiled for is known to DDS by its name and size only.
static bus::Codec codec_of(mapping::RecordType const& type, std::string_view name) {
    bus::Codec codec;
    codec.type_name = name;
    codec.keyed = type.keyed();
    codec.max_size = type.max_octets();
    return codec;
}

Result<bus::CdrWriter*> Gateway::writer_of(Route const& route) {
    auto const& topic = route.config.to.topic.name;
    auto& writer = writers_[topic];
    if (writer == nullptr) {
        auto made = node_.cdr_writer(topic, codec_of(*route.to_type, route.config.to.type.name));
        if (!made) {
            return std::unexpected{made.error()};
        }
        writer = std::move(*made);
    }
    return writer.get();
}

Result<void> Gateway::open_reader(Route const& route, Source& source) {
    MappingEnd const& from = route.config.from;
    auto const known =
        std::find_if(topics_.begin(), topics_.end(), [&](auto const& t) { return t->name == from.topic.name; });
    if (known != topics_.end()) {
        (*known)->sources.push_back(&source);
        return {};
    }
    auto reader = node_.cdr_reader(from.topic.name, codec_of(*route.from_type, from.type.name));
    if (!reader) {
        return std::unexpected{reader.error()};
    }
    topics_.push_back(
        std::make_unique<Topic>(Topic{from.topic.name, from.type.name, std::move(*reader), {&source}, {}}));
    return {};
}

Result<void> Gateway::open_signals() {
    std::string const& process = node_.config().process;
    auto const open = [&](std::string group, double rate_hz, std::vector<bus::SignalColumn> columns) {
        return bus::SignalPublisher::create(node_, std::move(group), rate_hz, std::move(columns));
    };
    if (!sampled_.empty()) {
        std::string const prefix = "publisher." + process + ".";
        auto counters =
            open("publisher", 1, {{prefix + "sent", ""}, {prefix + "late", ""}, {prefix + "underruns", ""}});
        if (!counters) {
            return std::unexpected{counters.error()};
        }
        counters_ = std::move(*counters);
    }
    for (std::size_t i = 0; i < sampled_.size() && !node_.lockstep(); ++i) {
        streams::Stream const& stream = sampled_[i].sink->stream();
        auto ages = open(fmt::format("age{}", i), stream.rate_hz.to_double(),
                         {{"stream." + stream.name.name + ".publish_age_ms", "ms"}});
        if (!ages) {
            return std::unexpected{ages.error()};
        }
        sampled_[i].ages = std::move(*ages);
    }
    for (std::size_t i = 0; i < routes_.size(); ++i) {
        Route const& route = routes_[i];
        watches_.push_back(nullptr);
        if (route.watched.empty()) {
            continue;
        }
        std::vector<bus::SignalColumn> columns;
        for (std::size_t const field : route.watched) {
            columns.push_back({fmt::format("mapping.{}.{}.{}", process, route.config.name.name, route.to[field].name),
                               route.to[field].unit});
        }
        auto signals = open(fmt::format("mapping{}", i), 0, std::move(columns));
        if (!signals) {
            return std::unexpected{signals.error()};
        }
        watches_.back() = std::make_unique<Watch>(Watch{std::move(*signals), {}});
        sources_[i]->observe({[this, watch = watches_.back().get(),
                               fields = route.watched](Moment at, std::span<mapping::Value const> values) {
                                  std::vector<double> row;
                                  for (std::size_t const field : fields) {
                                      row.push_back(values[field].number());
                                  }
                                  if (row != watch->last) {
                                      watch->signals->row(at.time, row);
                                      watch->last = std::move(row);
                                  }
                              },
                              {},
                              {}});
    }
    return {};
}

/// The rules of every mapping from a stream that has them.
Result<void> Gateway::open_first_line() {
    std::vector<FirstLineReport::Stream> watched;
    for (std::size_t i = 0; i < routes_.size(); ++i) {
        streams::Stream const* stream = routes_[i].from_stream;
        if (stream == nullptr || routes_[i].config.first_line.on_finding == FirstLineConfig::OnFinding::ignore) {
            continue;
        }
        Source* source = sources_[i].get();
        source->on_finding([this, at = watched.size()](Moment when, std::uint32_t findings, iec61850::Mac const& from) {
            first_line_->finding(at, findings, from, when.time);
        });
        // Two mappings of one stream see the same frames: the name of the mapping tells them apart.
        bool const again = std::any_of(watched.begin(), watched.end(), [&](auto const& w) { return w.name == stream->name.name; });
        watched.push_back({again ? stream->name.name + "." + routes_[i].config.name.name : stream->name.name, stream->kind,
                           [source] { return source->findings(); }, [source] { return source->first_line_refused(); },
                           [source] { return source->contested(); }});
    }
    if (watched.empty()) {
        return {};
    }
    auto report = FirstLineReport::create(node_, run_, std::move(watched));
    if (!report) {
        return std::unexpected{report.error()};
    }
    first_line_ = std::move(*report);
    return {};
}

void Gateway::begin(bus::Tick const& tick) {
    bool const has_zero = node_.start_unix_ns() != 0 || node_.config().clock.simulator.empty(); // UTC counts from 1970
    if (pacer_ != nullptr && has_zero) {
        pacer_->start(node_.start_unix_ns());
    }
    if (begun_) {
        return;
    }
    begun_ = true;
    if (counters_ != nullptr) {
        counters_->announce(tick.time);
    }
    for (Sampled const& sampled : sampled_) {
        if (sampled.ages != nullptr) {
            sampled.ages->announce(tick.time);
        }
    }
    for (auto const& watch : watches_) {
        if (watch != nullptr) {
            watch->signals->announce(tick.time);
        }
    }
    if (first_line_ != nullptr) {
        first_line_->announce(tick.time);
    }
    if (guest_ != nullptr) {
        guest_->announce(tick.time);
    }
    for (auto const& sink : sinks_) {
        sink->start(moment_of(tick));
    }
}

void Gateway::take_input(bus::Tick const& tick) {
    events_.clear();
    for (auto const& topic : topics_) {
        topic->due = topic->reader->take();
        for (std::size_t i = 0; i < topic->due.size(); ++i) {
            events_.push_back({topic->due[i].origin.time, topic.get(), i, nullptr, 0});
        }
    }
    for (std::uint16_t const ethertype : received_) {
        for (bus::WireFrame const* frame : port_->take(ethertype)) {
            events_.push_back({frame->time, nullptr, 0, frame, ethertype});
        }
    }
    if (!node_.lockstep()) { // as they came
        for (Event const& event : events_) {
            handle(event, {clock_.now(), event.topic != nullptr ? event.time : tick.time,
                           event.frame != nullptr ? event.frame->kernel_ns : 0});
        }
        return;
    }
    std::stable_sort(events_.begin(), events_.end(), [](Event const& a, Event const& b) { return a.time < b.time; });
    for (Event const& event : events_) {
        Moment const at{clock_.of(event.time), event.time};
        run_timers(at.ns - 1); // at one instant, what arrives comes before what is due
        handle(event, at);
    }
}

void Gateway::handle(Event const& event, Moment at) {
    if (event.topic != nullptr) {
        for (Source* source : event.topic->sources) {
            source->receive(at, event.topic->due[event.sample].value.cdr);
        }
        return;
    }
    handle(*event.frame, event.ethertype, at);
}

void Gateway::handle(bus::WireFrame const& frame, std::uint16_t ethertype, Moment at) {
    bool const sampled = ethertype == iec61850::kSvEthertype;
    auto const decoded = sampled ? iec61850::decode_sv(WirePort::octets(frame), *sv_)
                                 : iec61850::decode_goose(WirePort::octets(frame), goose_);
    if (!decoded) {
        if (undecodable_++ == 0) {
            log::warning("a frame cannot be decoded (octet {}): {} (more of them are only counted)",
                         decoded.error().offset, iec61850::reason_name(decoded.error().reason));
        }
        return;
    }
    for (auto const& source : sources_) {
        if (sampled) {
            source->receive(at, *sv_);
        } else {
            source->receive(at, goose_);
        }
    }
}

std::optional<std::int64_t> Gateway::next_timer() const {
    std::optional<std::int64_t> next;
    auto const consider = [&](std::optional<std::int64_t> due) { next = due && (!next || *due < *next) ? due : next; };
    for (auto const& sink : sinks_) {
        consider(sink->due());
    }
    for (auto const& source : sources_) {
        consider(source->deadline());
    }
    return next;
}

void Gateway::run_timers(std::int64_t until_ns) {
    for (auto next = next_timer(); next && *next <= until_ns; next = next_timer()) {
        std::int64_t const now = node_.lockstep() ? *next : until_ns;
        Moment const at{now, node_.lockstep() ? clock_.at_or_after(now) : node_.latest_time()};
        for (auto const& source : sources_) {
            if (auto const deadline = source->deadline(); deadline && *deadline <= now) {
                source->expire(at);
            }
        }
        for (auto const& sink : sinks_) {
            if (auto const due = sink->due(); due && *due <= now) {
                sink->work(now);
            }
        }
    }
}

void Gateway::publish_counters(bus::Tick const& tick) {
    if (!statistics_->due(tick.time, tick.final)) {
        return;
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        rows_[i]->refused(0);
        sinks_[i]->report(*rows_[i]);
        sources_[i]->report(*rows_[i]);
    }
    auto const& sent = port_->sent_counters();
    for (StreamStatistics* row : rows_) {
        row->dropped(row->direction() == STREAM_SENT ? sent.send_failed : port_->dropped());
    }
    statistics_->publish(tick.time);
    if (first_line_ != nullptr) {
        first_line_->report(tick.time);
    }
    if (counters_ == nullptr) {
        return;
    }
    std::array<double, 3> row{};
    for (Sampled const& sampled : sampled_) {
        row[0] += static_cast<double>(sampled.sink->sent());
        row[1] += static_cast<double>(sampled.sink->late());
        row[2] += static_cast<double>(sampled.sink->underruns());
    }
    counters_->row(tick.time, row);
    counters_->flush();
    for (Sampled const& sampled : sampled_) {
        if (tick.final && sampled.ages != nullptr) {
            sampled.ages->flush();
        }
    }
}

void Gateway::publish_ages() {
    for (Sampled const& sampled : sampled_) {
        double const rate_hz = sampled.sink->stream().rate_hz.to_double();
        for (SampleSink::Departure d; sampled.sink->pop_departure(d);) {
            double const time_s = static_cast<double>(d.index) / rate_hz;
            double const age_ms = clock_.age_ms(d.unix_ns, time_s, settings_.wire.speed);
            sampled.ages->row(node_.time_base().from_nanoseconds(std::llround(time_s * 1e9)), {&age_ms, 1});
        }
    }
}

int run_gateway(GatewayProgram const& program, GatewaySettings& settings, int argc, char** argv) {
    Daemon const daemon{program.name, program.description,
                        [&](config::Fields& f) {
                            program.describe(f);
                            describe_wire(f, settings.wire);
                        },
                        [&](config::Diagnostics& diagnostics) {
                            if (!program.complete) { // presets are checked when they know who they are
                                (void)make_routes(settings.gateway, settings.wire.streams, bus::idl_of_type,
                                                  diagnostics);
                            }
                        },
                        [&](DaemonRun& run) {
                            if (program.complete) {
                                program.complete(settings, run.bus);
                            }
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                auto const guest = program.guest ? program.guest(run) : nullptr;
                                return Gateway{settings, run, node, guest.get()}.run();
                            });
                        }};
    return run_daemon(daemon, argc, argv);
}

} // namespace gridspace::gateways
