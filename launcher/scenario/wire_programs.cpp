// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/wire_programs.hpp"

#include "common/text.hpp"
#include "gateways/breaker/breaker_config.hpp"
#include "gateways/first_line/first_line.hpp"
#include "gateways/mu/mu_config.hpp"
#include "gateways/port/frame_authentication.hpp"
#include "gateways/port/wire_config.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_use.hpp"
#include "sim/gateway/gateway_config.hpp"
#include "sim/network/network.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;
using streams::Kind;
using streams::Stream;

/// What the events do to the clock of a merging unit, in their order.
Node clock_changes(Scenario const& s, Process const& process) {
    std::vector<sim::Event const*> events;
    for (sim::Event const& event : s.events) {
        if (event.at_s && (event.desynchronise == process.name || event.resynchronise == process.name)) {
            events.push_back(&event);
        }
    }
    std::stable_sort(events.begin(), events.end(), [](auto const* a, auto const* b) { return *a->at_s < *b->at_s; });
    Node list = Node::sequence();
    for (sim::Event const* event : events) {
        Node node = Node::map();
        bool const synchronised = event->resynchronise == process.name;
        node.set("at_s", Node::scalar(event->at_s->to_string()));
        node.set("synchronised", Node::scalar(synchronised ? "true" : "false"));
        node.set("shift_samples", Node::scalar(std::to_string(synchronised ? 0 : event->shift_samples)));
        list.items.push_back(std::move(node));
    }
    return list;
}

class MergingUnitSettings final : public ProcessSettings {
  public:
    explicit MergingUnitSettings(Fields& f) { describe(f, config_); }
    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        check_raw_link(s, process, diagnostics);
        Stream const* stream = must_be_stream(s, config_.to, Kind::smv, diagnostics);
        for (std::string const& member : config_.channels) {
            must_have_member(stream, member, config_.to, false, diagnostics);
        }
        for (std::string const& member : config_.voltages.value_or(std::array<std::string, 3>{})) {
            if (!member.empty()) {
                must_have_member(stream, member, config_.to, false, diagnostics);
            }
        }
        auto const sampled = sim::read_sampling(s.simulation.sampling, diagnostics).rate_hz;
        if (stream != nullptr && stream->rate_hz != sampled) {
            diagnostics.error(config_.to.where,
                              fmt::format("process '{}' sends '{}' at {} Hz, and the simulator samples at {} Hz",
                                          process.name.name, config_.to.name, stream->rate_hz.to_string(),
                                          sampled.to_string()),
                              "make rate_hz of the stream and of simulation.sampling the same",
                              static_cast<int>(config_.to.name.size()));
        }
    }
    [[nodiscard]] std::vector<TopicUse> writes(Scenario const&, Process const&) const override {
        std::vector<TopicUse> out;
        add_signals(out);
        out.push_back({"stream_statistics", "StreamStatistics", 1, false, true});
        return out;
    }
    [[nodiscard]] std::vector<TopicUse> reads(Scenario const&, Process const&) const override {
        return {{config_.from.name, config_.type(), 1, true}};
    }
    [[nodiscard]] std::vector<WireUse> sends(Scenario const& s, Process const& process) const override {
        return {use_of(s, process, config_.to)};
    }
    [[nodiscard]] std::vector<SignalUse> signals(Scenario const& s, Process const& process) const override {
        std::string const prefix = "publisher." + process.name.name + ".";
        std::vector<SignalUse> out{{prefix + "sent", "", 1}, {prefix + "late", "", 1}, {prefix + "underruns", "", 1}};
        for (char const* name : {"publish_age_ms", "wire_delay_ms"}) {
            out.push_back({"stream." + config_.to.name + "." + name, "ms", 0});
        }
        add_clock_signals(s, process, config_.ptp, out);
        return out;
    }
    [[nodiscard]] Rational latency_s(Process const&) const override { return config_.latency_us / Rational{1'000'000}; }
    [[nodiscard]] Rational promises_s(Process const& process) const override { return latency_s(process); }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        Node node = wire_process_settings(s, process, {config_.to.name});
        node.set("clock_changes", clock_changes(s, process));
        return node;
    }
    [[nodiscard]] gateways::MuConfig const& config() const { return config_; }

  private:
    gateways::MuConfig config_;
};

class BreakerSettings final : public ProcessSettings {
  public:
    explicit BreakerSettings(Fields& f) { describe(f, config_); }
    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        check_raw_link(s, process, diagnostics);
        must_have_member(must_be_stream(s, config_.stream(), Kind::goose, diagnostics), config_.field(), config_.from,
                         true, diagnostics);
    }
    [[nodiscard]] std::vector<TopicUse> writes(Scenario const&, Process const&) const override {
        std::vector<TopicUse> out{{config_.to.name, "TripCommand"}};
        add_signals(out);
        out.push_back({"stream_statistics", "StreamStatistics", 1, false, true});
        return out;
    }
    [[nodiscard]] std::vector<WireUse> receives(Scenario const& s, Process const& process) const override {
        return {use_of(s, process, config_.stream())};
    }
    [[nodiscard]] std::vector<SignalUse> signals(Scenario const& s, Process const& process) const override {
        std::string const prefix = "breaker_ied." + process.name.name + ".";
        std::vector<SignalUse> out{{prefix + "command", "", 0},
                                   {prefix + "stream_alive", "", 0},
                                   {prefix + "commanded_after_ms", "ms", 0},
                                   {prefix + "effect_ms", "ms", 0}};
        add_first_line_signals(s, process, config_.first_line, {{config_.stream().name, false}}, out);
        return out;
    }
    [[nodiscard]] Rational latency_s(Process const&) const override { return config_.latency_us / Rational{1'000'000}; }
    [[nodiscard]] bool works_ahead() const override { return true; }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        return wire_process_settings(s, process, {config_.stream().name});
    }

  private:
    gateways::BreakerConfig config_;
};

} // namespace

void add_clock_signals(Scenario const& s, Process const& process, std::optional<ptp::PtpConfig> const& ptp,
                       std::vector<SignalUse>& out) {
    if (ptp && s.clock.mode == bus::ClockMode::realtime) { // as ClockFollower makes them
        std::string const prefix = "clock." + process.name.name + ".";
        out.push_back({prefix + "smp_synch", "", 0});
        out.push_back({prefix + "offset_us", "us", 0});
    }
}

void add_first_line_signals(Scenario const& s, Process const& process, gateways::FirstLineConfig const& config,
                            std::vector<std::pair<std::string, bool>> const& streams, std::vector<SignalUse>& out) {
    if (config.on_finding == gateways::FirstLineConfig::OnFinding::ignore || streams.empty()) {
        return;
    }
    std::string const prefix = "first_line." + process.name.name + ".";
    out.push_back({prefix + "alarm", "", 0});
    for (auto const& [stream, sampled_values] : streams) {
        for (std::string const& name : gateways::first_line_counters(sampled_values)) {
            out.push_back({prefix + stream + "." + name, "", 1});
        }
        Stream const* const declared = streams::find_stream(s.streams, stream);
        if (declared != nullptr && declared->authentication) {
            for (std::string const& name : gateways::authenticity_counters()) {
                out.push_back({prefix + stream + "." + name, "", 1});
            }
        }
    }
}

void add_signals(std::vector<TopicUse>& topics) {
    topics.push_back({"signals", "SignalFrame"});
    topics.push_back({"signal_catalog", "SignalCatalog"});
}

Node wire_process_settings(Scenario const& s, Process const& process, std::vector<std::string> const& used) {
    Node node = own_settings(process);
    node.set("wire", wire_settings(s, process));
    Node declared = Node::map();
    Node const* all = s.resolved.find("streams");
    for (std::string const& name : used) {
        if (Node const* stream = all == nullptr ? nullptr : all->find(name)) {
            declared.set(name, *stream);
            Stream const* const read = streams::find_stream(s.streams, name);
            if (read != nullptr && read->authentication && !read->authentication->key_file.empty()) {
                auto const file = std::filesystem::absolute(read->authentication->key_file).lexically_normal();
                declared.find(name)->find("authentication")->set("key_file", Node::quoted_text(file.string()));
            }
        }
    }
    node.set("streams", std::move(declared));
    return node;
}

sim::Ct const* transformer_behind(Scenario const& s, Ref const& stream) {
    Diagnostics ignored; // reported elsewhere
    auto const gateways = sim::read_gateways(s.simulation.gateways, ignored);
    for (Process const& process : s.processes) {
        auto const* unit = dynamic_cast<MergingUnitSettings const*>(process.settings.get());
        if (unit == nullptr || unit->config().to != stream || !s.network) {
            continue;
        }
        for (sim::LineGatewayConfig const& gateway : gateways.lines) {
            for (auto const& publish : gateway.publish) {
                if (publish.topic != unit->config().from) {
                    continue;
                }
                if (sim::Ct const* ct = sim::find(s.network->cts, publish.transformer.name)) {
                    return ct;
                }
            }
        }
    }
    return nullptr;
}

std::unique_ptr<ProcessSettings> read_merging_unit(Fields& f) {
    return std::make_unique<MergingUnitSettings>(f);
}
std::unique_ptr<ProcessSettings> read_breaker(Fields& f) {
    return std::make_unique<BreakerSettings>(f);
}
} // namespace gridspace::launcher
