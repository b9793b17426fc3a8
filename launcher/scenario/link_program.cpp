// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/link/link_config.hpp"
#include "gateways/link/link_declaration.hpp"
#include "launcher/scenario/bumps.hpp"
#include "launcher/scenario/declared_program.hpp"
#include "launcher/scenario/impairments.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_programs.hpp"

#include "common/text.hpp"

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;

/// Whoever looks for a stream in the settings must find it: the declarations of all that are named.
Node declarations(Scenario const& s, gateways::LinkConfig const& config) {
    Node out = Node::map();
    Node const* all = s.resolved.find("streams");
    auto const add = [&](Ref const& name) {
        if (Node const* stream = all == nullptr ? nullptr : all->find(name.name)) {
            out.set(name.name, *stream);
        }
    };
    for (Ref const& name : config.streams) {
        add(name);
    }
    for (auto const& entry : config.samples) {
        add(entry.stream);
    }
    return out;
}

class LinkSettings final : public DeclaredSettings {
  public:
    explicit LinkSettings(Fields& f) : DeclaredSettings{gateways::link_declaration()} { describe(f, config_); }
    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        check_bumps(s, process, diagnostics);
        (void)gateways::make_plan(config_, s.streams, diagnostics);
    }
    [[nodiscard]] std::vector<BumpUse> bumps(Scenario const&, Process const&) const override {
        using Direction = gateways::LinkConfig::Direction;
        if (config_.between.size() != 2) {
            return {}; // reported when it was read
        }
        return {{config_.between[0], config_.between[1], config_.direction != Direction::to_host,
                 config_.direction != Direction::from_host}};
    }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        Node node = own_settings(process);
        node.set("bumps", bump_settings(s, process));
        node.set("seed", Node::scalar(std::to_string(s.seed)));
        node.set("streams", declarations(s, config_));
        node.set("changes", impairment_changes(s, process.name.name));
        if (s.clock.mode == bus::ClockMode::realtime && s.clock.speed > 0) {
            node.set("speed", Node::scalar(shortest(s.clock.speed)));
        }
        return node;
    }

  private:
    gateways::LinkConfig config_;
};

} // namespace

std::unique_ptr<ProcessSettings> read_link(Fields& f) {
    return std::make_unique<LinkSettings>(f);
}

} // namespace gridspace::launcher
