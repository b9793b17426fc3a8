// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/wire_programs.hpp"

#include "common/text.hpp"
#include "gateways/breaker/breaker_declaration.hpp"
#include "gateways/mu/mu_declaration.hpp"
#include "gateways/port/wire_config.hpp"
#include "launcher/scenario/declared_program.hpp"
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

class MergingUnitSettings final : public DeclaredSettings {
  public:
    explicit MergingUnitSettings(Fields& f) : DeclaredSettings{gateways::mu_declaration()} { describe(f, config_); }
    void settle(Scenario const& s, Process const&) override { declare(gateways::declaration(config_, context_of(s))); }
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
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        Node node = DeclaredSettings::settings(s, process);
        node.set("clock_changes", clock_changes(s, process));
        return node;
    }
    [[nodiscard]] gateways::MuConfig const& config() const { return config_; }

  private:
    gateways::MuConfig config_;
};

class BreakerSettings final : public DeclaredSettings {
  public:
    explicit BreakerSettings(Fields& f) : DeclaredSettings{gateways::breaker_declaration()} { describe(f, config_); }
    void settle(Scenario const& s, Process const&) override { declare(gateways::declaration(config_, context_of(s))); }
    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        check_raw_link(s, process, diagnostics);
        must_have_member(must_be_stream(s, config_.stream(), Kind::goose, diagnostics), config_.field(), config_.from,
                         true, diagnostics);
    }

  private:
    gateways::BreakerConfig config_;
};

} // namespace

gateways::DeclarationContext context_of(Scenario const& s) {
    return {s.streams, s.clock.mode == bus::ClockMode::realtime};
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
