// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-gateway, as the launcher sees it: its table checked against the scenario, and what follows from the table.
#include "bus/topics.hpp"
#include "common/text.hpp"
#include "gateways/gateway/route.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_programs.hpp"
#include "launcher/scenario/wire_use.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <set>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;
using gateways::MappingConfig;
using gateways::Route;

class GatewaySettings final : public ProcessSettings {
  public:
    explicit GatewaySettings(Fields& f) { describe(f, config_); }

    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        check_raw_link(s, process, diagnostics);
        routes_ = gateways::make_routes(config_, s.streams, bus::idl_of_type, diagnostics);
        for (Route const& route : routes_) {
            if (route.to_samples()) {
                check_samples_on_steps(s, *route.to_stream, route.config.to.stream, diagnostics);
            }
        }
    }

    [[nodiscard]] std::vector<TopicUse> writes(Scenario const& s, Process const& process) const override {
        std::vector<TopicUse> out;
        std::set<std::string> seen; // several mappings may write one topic: there is one writer
        for (MappingConfig const& mapping : config_.mappings) {
            if (mapping.to.is_topic() && seen.insert(mapping.to.topic.name).second) {
                out.push_back({mapping.to.topic.name, mapping.to.type.name, 1, false, true});
            }
        }
        if (!signals(s, process).empty()) { // without any it opens no writer
            add_signals(out);
        }
        out.push_back({"stream_statistics", "StreamStatistics", 1, false, true});
        return out;
    }
    [[nodiscard]] std::vector<TopicUse> reads(Scenario const&, Process const&) const override {
        std::vector<TopicUse> out;
        std::set<std::string> seen;
        for (MappingConfig const& mapping : config_.mappings) {
            if (mapping.from.is_topic() && seen.insert(mapping.from.topic.name).second) {
                out.push_back({mapping.from.topic.name, mapping.from.type.name, 1, true});
            }
        }
        return out;
    }
    [[nodiscard]] std::vector<WireUse> sends(Scenario const& s, Process const& process) const override {
        return uses(s, process, &MappingConfig::to);
    }
    [[nodiscard]] std::vector<WireUse> receives(Scenario const& s, Process const& process) const override {
        std::vector<WireUse> out = uses(s, process, &MappingConfig::from);
        for (gateways::SubscriptionConfig const& one : config_.subscriptions) {
            if (streams::find_stream(s.streams, one.stream.name) != nullptr) {
                out.push_back(use_of(s, process, one.stream));
            }
        }
        return out;
    }
    [[nodiscard]] std::vector<SignalUse> signals(Scenario const& s, Process const& process) const override {
        std::vector<SignalUse> out;
        std::string const prefix = "publisher." + process.name.name + ".";
        for (MappingConfig const& mapping : config_.mappings) {
            streams::Stream const* stream = streams::find_stream(s.streams, mapping.to.stream.name);
            if (stream == nullptr || stream->kind != streams::Kind::smv) {
                continue;
            }
            if (out.empty()) {
                out = {{prefix + "sent", "", 1}, {prefix + "late", "", 1}, {prefix + "underruns", "", 1}};
            }
            for (char const* name : {"publish_age_ms", "wire_delay_ms"}) {
                out.push_back({"stream." + stream->name.name + "." + name, "ms", 0});
            }
        }
        std::vector<std::pair<std::string, bool>> watched; // names as Gateway::open_first_line makes them
        for (MappingConfig const& mapping : config_.mappings) {
            streams::Stream const* stream = streams::find_stream(s.streams, mapping.from.stream.name);
            if (stream == nullptr || mapping.first_line.on_finding == gateways::FirstLineConfig::OnFinding::ignore) {
                continue;
            }
            bool const again = std::any_of(watched.begin(), watched.end(),
                                           [&](auto const& w) { return w.first == stream->name.name; });
            watched.emplace_back(again ? stream->name.name + "." + mapping.name.name : stream->name.name,
                                 stream->kind == streams::Kind::smv);
        }
        add_clock_signals(s, process, config_.ptp, out);
        add_first_line_signals(s, process, {}, watched, out);
        for (Route const& route : routes_) {
            for (std::size_t const field : route.watched) {
                out.push_back(
                    {fmt::format("mapping.{}.{}.{}", process.name.name, route.config.name.name, route.to[field].name),
                     route.to[field].unit, 0});
            }
        }
        for (gateways::SubscriptionConfig const& one : config_.subscriptions) {
            if (streams::Stream const* const stream = streams::find_stream(s.streams, one.stream.name)) {
                for (std::string& name : gateways::subscription_signals(process.name.name, one, *stream)) {
                    out.push_back({std::move(name), "", 0});
                }
            }
        }
        return out;
    }
    [[nodiscard]] Rational latency_s(Process const&) const override { return config_.latency_us / Rational{1'000'000}; }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        std::vector<std::string> used;
        for (MappingConfig const& mapping : config_.mappings) {
            used.push_back(mapping.from.stream.empty() ? mapping.to.stream.name : mapping.from.stream.name);
        }
        for (gateways::SubscriptionConfig const& one : config_.subscriptions) {
            used.push_back(one.stream.name);
        }
        return wire_process_settings(s, process, used);
    }

  private:
    std::vector<WireUse> uses(Scenario const& s, Process const& process,
                              gateways::MappingEnd MappingConfig::* end) const {
        std::vector<WireUse> out;
        for (MappingConfig const& mapping : config_.mappings) {
            if (auto const* stream = streams::find_stream(s.streams, (mapping.*end).stream.name)) {
                out.push_back({raw_link(s, process), stream->ethertype(), stream->name.name});
            }
        }
        return out;
    }

    gateways::GatewayConfig config_;
    std::vector<Route> routes_; ///< after check()
};

} // namespace

std::unique_ptr<ProcessSettings> read_gateway(Fields& f) {
    return std::make_unique<GatewaySettings>(f);
}

} // namespace gridspace::launcher
