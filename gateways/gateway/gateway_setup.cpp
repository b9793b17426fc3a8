// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What a gateway opens before the clock starts: routes, their sources and sinks, signals, reports.
#include "bus/topics.hpp"
#include "common/log.hpp"
#include "gateways/gateway/gateway_declaration.hpp"
#include "gateways/gateway/gateway_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::gateways {
namespace {

/// What the gateway sends and receives.
WirePort::Ethertypes ethertypes_of(std::vector<Route> const& routes, GatewaySettings const& settings) {
    WirePort::Ethertypes ethertypes;
    auto const add = [](std::vector<std::uint16_t>& list, streams::Stream const* stream) {
        if (stream != nullptr && std::find(list.begin(), list.end(), stream->ethertype()) == list.end()) {
            list.push_back(stream->ethertype());
        }
    };
    for (Route const& route : routes) {
        add(ethertypes.send, route.to_stream);
        add(ethertypes.receive, route.from_stream);
    }
    for (SubscriptionConfig const& one : settings.gateway.subscriptions) {
        add(ethertypes.receive, streams::find_stream(settings.wire.streams, one.stream.name));
    }
    return ethertypes;
}

} // namespace

Result<void> Gateway::prepare() {
    config::Diagnostics diagnostics;
    routes_ = make_routes(settings_.gateway, settings_.wire.streams, bus::idl_of_type, diagnostics);
    if (!diagnostics.ok()) {
        return fail(ExitCode::usage, diagnostics.render());
    }
    WirePort::Ethertypes const ethertypes = ethertypes_of(routes_, settings_);
    received_ = ethertypes.receive;
    auto port = WirePort::open(node_, settings_.wire, ethertypes);
    if (!port) {
        return std::unexpected{port.error()};
    }
    port_ = std::move(*port);
    context_ = std::make_unique<GatewayContext>(
        GatewayContext{node_, *port_, settings_.wire, WireClock{node_},
                       node_.time_base().ceil(settings_.gateway.latency_us / Rational{1'000'000})});
    if (settings_.gateway.ptp && !node_.lockstep()) { // in lockstep simulated time is the clock
        auto follower = ClockFollower::create(node_, run_, *settings_.gateway.ptp);
        if (!follower) {
            return std::unexpected{follower.error()};
        }
        follower_ = std::move(*follower);
        context_->follower = follower_.get();
    }
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
    if (auto ok = open_subscriptions(); !ok) {
        return ok;
    }
    if (auto ok = open_pacer(); !ok) {
        return ok;
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
    return {};
}

Result<void> Gateway::open_pacer() {
    std::vector<ZeroOrderHoldSink*> held;
    for (Sampled const& sampled : sampled_) {
        if (auto* const sink = dynamic_cast<ZeroOrderHoldSink*>(sampled.sink); sink != nullptr && !node_.lockstep()) {
            held.push_back(sink);
        }
    }
    if (!held.empty()) {
        auto pacer = SamplePacer::create(settings_.wire, *port_, std::move(held));
        if (!pacer) {
            return std::unexpected{pacer.error()};
        }
        pacer_ = std::move(*pacer);
    }
    return {};
}

Result<void> Gateway::open_route(Route& route) {
    auto sink = open_sink(route);
    if (!sink) {
        return std::unexpected{sink.error()};
    }
    if (!route.config.has_source()) {
        sources_.push_back(make_constant_source(route, **sink, clock_, settings_.wire.speed));
    } else if (route.from_stream == nullptr) {
        sources_.push_back(make_topic_source(route, **sink));
    } else if (route.from_stream->kind == streams::Kind::smv) {
        sources_.push_back(
            make_sv_source(route, **sink, node_.lockstep(), settings_.wire.speed, settings_.wire.streams));
    } else {
        sources_.push_back(make_goose_source(route, **sink, clock_));
    }
    streams::Stream const& stream = route.from_stream != nullptr ? *route.from_stream : *route.to_stream;
    rows_.push_back(&statistics_->add(stream.name.name, route.from_stream != nullptr ? STREAM_RECEIVED : STREAM_SENT));
    return route.from_type != nullptr ? open_reader(route, *sources_.back()) : Result<void>{};
}

Result<void> Gateway::open_subscriptions() {
    for (SubscriptionConfig const& one : settings_.gateway.subscriptions) {
        auto const& stream = *streams::find_stream(settings_.wire.streams, one.stream.name); // checked with the routes
        auto made = Subscription::create(node_, clock_, one, stream, settings_.wire.speed, subscriptions_.size());
        if (!made) {
            return std::unexpected{made.error()};
        }
        subscriptions_.push_back(std::move(*made));
        rows_.push_back(&statistics_->add(stream.name.name, STREAM_RECEIVED));
    }
    return {};
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
        auto sink = ZeroOrderHoldSink::create(*context_, route);
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
    if (!sampled_.empty()) {
        auto counters = bus::SignalPublisher::create(node_, "publisher", publisher_signals(), {});
        if (!counters) {
            return std::unexpected{counters.error()};
        }
        counters_ = std::move(*counters);
    }
    for (std::size_t i = 0; i < sampled_.size() && !node_.lockstep(); ++i) {
        streams::Stream const& stream = sampled_[i].sink->stream();
        program::Signal const age = sent_sample_signals(stream.name.name).front();
        auto ages = bus::SignalPublisher::create(node_, fmt::format("age{}", i), stream.rate_hz.to_double(),
                                                 {{age.name, age.unit}});
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
        auto signals = bus::SignalPublisher::create(node_, fmt::format("mapping{}", i), watched_signals(route), {});
        if (!signals) {
            return std::unexpected{signals.error()};
        }
        watches_.back() = std::make_unique<Watch>(Watch{std::move(*signals), {}});
        sources_[i]->observe({[watch = watches_.back().get(),
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
        bool const again =
            std::any_of(watched.begin(), watched.end(), [&](auto const& w) { return w.name == stream->name.name; });
        watched.push_back({again ? stream->name.name + "." + routes_[i].config.name.name : stream->name.name,
                           stream->kind, [source] { return source->findings(); },
                           [source] { return source->first_line_refused(); },
                           [source] { return source->contested(); }});
    }
    if (watched.empty()) {
        return {};
    }
    auto report = FirstLineReport::create(node_, run_, std::move(watched), port_->authentication());
    if (!report) {
        return std::unexpected{report.error()};
    }
    first_line_ = std::move(*report);
    return {};
}

} // namespace gridspace::gateways
