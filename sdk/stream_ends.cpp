// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sdk/stream_ends.hpp"

#include "common/text.hpp"
#include "gateways/gateway/sample_sink.hpp"
#include "gateways/mapping/record_writer.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace gridspace::sdk {

using gateways::Moment;
using gateways::Route;

/// The end of a mapping from a stream: a sample of the program's reader for every put().
class InwardSink final : public gateways::Sink {
  public:
    InwardSink(StreamEnds& ends, Route& route, std::shared_ptr<TopicType const> type, int reader)
        : Sink{route}, ends_{ends}, route_{route}, type_{std::move(type)}, record_{*route.to_type, route.written},
          reader_{reader} {}

    void put(Moment at, std::int64_t) override {
        std::copy(values_.begin(), values_.end(), record_.values().begin());
        record_.values()[*route_.time_field] =
            mapping::Value::integer(iec61850::BasicType::int64, ends_.node_.time_base().nanoseconds(at.time));
        SampleBlock* const block = SampleBlock::decode(type_->layout(), record_.write());
        if (block != nullptr && ends_.arrivals_ != nullptr) {
            constexpr std::uint32_t kBehindTopics = UINT32_MAX;
            ends_.arrivals_->push_back({{at.time, kBehindTopics, 0, ends_.arrived_++}, reader_, KeptSample{block}});
        }
    }

  private:
    StreamEnds& ends_;
    Route& route_;
    std::shared_ptr<TopicType const> type_;
    mapping::RecordWriter record_;
    int reader_;
};

StreamEnds::StreamEnds(bus::Node& node, gateways::WireConfig const& wire) : node_{node}, wire_{wire}, clock_{node} {}
StreamEnds::~StreamEnds() = default;

Result<std::unique_ptr<StreamEnds>> StreamEnds::open(bus::Node& node, gateways::WireConfig const& wire, SimSpan latency,
                                                     std::vector<std::string> const& reads,
                                                     std::vector<std::string> const& writes, int first_reader) {
    auto out = std::unique_ptr<StreamEnds>{new StreamEnds{node, wire}};
    gateways::WirePort::Ethertypes ethertypes;
    for (auto const& [names, list] : {std::pair{&reads, &ethertypes.receive}, {&writes, &ethertypes.send}}) {
        for (std::string const& name : *names) {
            streams::Stream const* const stream = streams::find_stream(out->wire_.streams, name);
            if (stream == nullptr) {
                return fail(ExitCode::usage, fmt::format("there is no stream '{}'", name));
            }
            if (std::find(list->begin(), list->end(), stream->ethertype()) == list->end()) {
                list->push_back(stream->ethertype());
            }
        }
    }
    auto port = gateways::WirePort::open(node, out->wire_, ethertypes);
    if (!port) {
        return std::unexpected{port.error()};
    }
    out->port_ = std::move(*port);
    out->ethertypes_ = ethertypes.receive;
    out->context_ = std::make_unique<gateways::GatewayContext>(
        gateways::GatewayContext{node, *out->port_, out->wire_, gateways::WireClock{node}, latency});
    auto statistics = gateways::StatisticsPublisher::create(node);
    if (!statistics) {
        return std::unexpected{statistics.error()};
    }
    out->statistics_ = std::move(*statistics);
    for (std::string const& name : reads) {
        if (auto ok = out->open_read(*streams::find_stream(out->wire_.streams, name), first_reader++); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    std::vector<gateways::ZeroOrderHoldSink*> held;
    for (std::string const& name : writes) {
        if (auto ok = out->open_write(*streams::find_stream(out->wire_.streams, name)); !ok) {
            return std::unexpected{ok.error()};
        }
        if (auto* const sink = dynamic_cast<gateways::ZeroOrderHoldSink*>(out->outward_.back().get())) {
            held.push_back(sink);
        }
    }
    if (!held.empty() && !node.lockstep()) {
        auto pacer = gateways::SamplePacer::create(out->wire_, *out->port_, std::move(held));
        if (!pacer) {
            return std::unexpected{pacer.error()};
        }
        out->pacer_ = std::move(*pacer);
    }
    return out;
}

Result<Route*> StreamEnds::add_route(streams::Stream const& stream, StreamType const& type, std::vector<End>& ends) {
    auto loaded = TopicType::of_text(type.idl, type.name, fmt::format(" (stream '{}')", stream.name.name));
    if (!loaded) {
        return std::unexpected{loaded.error()};
    }
    config::Diagnostics diagnostics;
    routes_.push_back(std::make_unique<Route>(gateways::make_route(
        type.mapping, wire_.streams, [&](std::string_view) -> std::string_view { return type.idl; }, diagnostics)));
    if (!diagnostics.ok()) {
        return fail(ExitCode::usage, diagnostics.render());
    }
    ends.push_back({stream.name.name, std::move(*loaded)});
    return routes_.back().get();
}

Result<void> StreamEnds::open_read(streams::Stream const& stream, int reader) {
    auto const route = add_route(stream, type_of_read(stream), reads_);
    if (!route) {
        return std::unexpected{route.error()};
    }
    inward_.push_back(std::make_unique<InwardSink>(*this, **route, reads_.back().type, reader));
    received_.push_back(stream.kind == streams::Kind::smv
                            ? make_sv_source(**route, *inward_.back(), node_.lockstep(), wire_.speed, wire_.streams)
                            : make_goose_source(**route, *inward_.back(), clock_));
    rows_.push_back(&statistics_->add(stream.name.name, STREAM_RECEIVED));
    return {};
}

Result<void> StreamEnds::open_write(streams::Stream const& stream) {
    auto const route = add_route(stream, type_of_written(stream), writes_);
    if (!route) {
        return std::unexpected{route.error()};
    }
    if (stream.kind == streams::Kind::goose) {
        auto sink = gateways::make_goose_sink(*context_, **route);
        if (!sink) {
            return std::unexpected{sink.error()};
        }
        outward_.push_back(std::move(*sink));
    } else {
        auto sink = gateways::ZeroOrderHoldSink::create(*context_, **route);
        if (!sink) {
            return std::unexpected{sink.error()};
        }
        outward_.push_back(std::move(*sink));
    }
    written_.push_back(make_topic_source(**route, *outward_.back()));
    rows_.push_back(&statistics_->add(stream.name.name, STREAM_SENT));
    return {};
}

void StreamEnds::follow_start() {
    if (pacer_ != nullptr && node_.start_unix_ns() != 0) {
        pacer_->start(node_.start_unix_ns());
    }
}

void StreamEnds::begin(bus::Tick const& tick) {
    follow_start();
    for (auto const& sink : outward_) {
        sink->start({clock_.at_tick(tick.time), tick.time});
    }
}

void StreamEnds::take(bus::Tick const& tick, std::vector<SampleInbox::Arrival>& arrivals) {
    follow_start();
    arrivals_ = &arrivals;
    due_.clear();
    for (std::uint16_t const ethertype : ethertypes_) {
        for (bus::WireFrame const* frame : port_->take(ethertype)) {
            due_.push_back({frame->time, frame, ethertype});
        }
    }
    if (node_.lockstep()) { // in real time as they came
        std::stable_sort(due_.begin(), due_.end(), [](Due const& a, Due const& b) { return a.time < b.time; });
    }
    for (Due const& due : due_) {
        Moment at{clock_.now(), tick.time, due.frame->kernel_ns, due.frame->arrived_ns};
        if (clock_.simulated()) {
            at = {clock_.of(due.time), due.time};
            expire(at.ns - 1); // at one instant, what arrives comes before what has run out
        }
        handle(*due.frame, due.ethertype, at);
    }
    expire(clock_.at_tick(tick.time));
    arrivals_ = nullptr;
}

void StreamEnds::handle(bus::WireFrame const& frame, std::uint16_t ethertype, Moment at) {
    iec61850::Octets const octets = gateways::WirePort::octets(frame);
    bool const sampled = ethertype == iec61850::kSvEthertype;
    bool const decoded =
        sampled ? iec61850::decode_sv(octets, *sv_).has_value() : iec61850::decode_goose(octets, goose_).has_value();
    for (std::size_t i = 0; decoded && i < received_.size(); ++i) {
        if (sampled) {
            received_[i]->receive(at, *sv_);
        } else {
            received_[i]->receive(at, goose_);
        }
    }
}

void StreamEnds::write(std::size_t stream, std::span<std::byte const> cdr, SimTime now) {
    written_[stream]->receive({clock_.simulated() ? clock_.of(now) : clock_.now(), now}, cdr);
}

std::optional<std::int64_t> StreamEnds::next_expiry() const {
    std::optional<std::int64_t> next;
    for (auto const& source : received_) {
        auto const at = source->deadline();
        next = at && (!next || *at < *next) ? at : next;
    }
    return next;
}

std::optional<std::int64_t> StreamEnds::next_send() const {
    std::optional<std::int64_t> next;
    for (auto const& sink : outward_) {
        auto const at = sink->due();
        next = at && (!next || *at < *next) ? at : next;
    }
    return next;
}

void StreamEnds::expire(std::int64_t until_ns) {
    if (auto const next = next_expiry(); next && *next <= until_ns && !clock_.simulated()) {
        port_->drain(); // what has come by now is seen in the next round, and counts before what has run out
    }
    for (auto next = next_expiry(); next && *next <= until_ns; next = next_expiry()) {
        std::int64_t const now = clock_.simulated() ? *next : until_ns;
        for (auto const& source : received_) {
            if (auto const at = source->deadline(); at && *at <= now) {
                source->expire({now, clock_.sim_time(now)});
            }
        }
    }
}

void StreamEnds::send(std::int64_t until_ns) {
    for (auto next = next_send(); next && *next <= until_ns; next = next_send()) {
        std::int64_t const now = clock_.simulated() ? *next : until_ns;
        for (auto const& sink : outward_) {
            if (auto const at = sink->due(); at && *at <= now) {
                sink->work(now);
            }
        }
    }
}

void StreamEnds::send_before(SimTime now) {
    send(clock_.simulated() ? clock_.of(now) - 1 : clock_.now());
}

void StreamEnds::finish(bus::Tick const& tick) {
    last_ = {clock_.at_tick(tick.time), tick.time};
    send(last_.ns);
    if (tick.final) {
        end();
    }
    port_->maintain();
    if (!statistics_->due(tick.time, tick.final)) {
        return;
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        rows_[i]->refused(0);
        bool const is_read = i < received_.size();
        std::size_t const at = is_read ? i : i - received_.size();
        (is_read ? inward_ : outward_)[at]->report(*rows_[i]);
        (is_read ? received_ : written_)[at]->report(*rows_[i]);
        rows_[i]->dropped(is_read ? port_->dropped() : port_->sent_counters().send_failed);
    }
    statistics_->publish(tick.time);
}

std::optional<SimTime> StreamEnds::next() const {
    auto const expiry = next_expiry(), sending = next_send();
    auto const first = !expiry ? sending : !sending ? expiry : std::min(expiry, sending);
    return first ? std::optional{clock_.at_or_after(*first)} : std::nullopt;
}

std::chrono::steady_clock::time_point StreamEnds::deadline() const {
    std::int64_t const soon = clock_.now() + 1'000'000'000;
    return gateways::WireClock::wall(std::min({next_expiry().value_or(soon), next_send().value_or(soon), soon}));
}

void StreamEnds::end() {
    if (!std::exchange(ended_, true)) {
        for (auto const& sink : outward_) {
            sink->finish(last_);
        }
    }
}

} // namespace gridspace::sdk
