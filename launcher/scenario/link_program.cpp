// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/link/link_config.hpp"
#include "launcher/scenario/cut_ins.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_programs.hpp"

#include "common/text.hpp"

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;

class LinkSettings final : public ProcessSettings {
  public:
    explicit LinkSettings(Fields& f) { describe(f, config_); }
    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        check_cut_ins(s, process, diagnostics);
    }
    [[nodiscard]] std::vector<CutInUse> cut_ins(Scenario const&, Process const&) const override {
        using Direction = gateways::LinkConfig::Direction;
        if (config_.between.size() != 2) {
            return {}; // reported when it was read
        }
        return {{config_.between[0], config_.between[1], config_.direction != Direction::to_host,
                 config_.direction != Direction::from_host}};
    }
    [[nodiscard]] Node settings(Scenario const& s, Process const& process) const override {
        Node node = own_settings(process);
        node.set("cut_ins", cut_in_settings(s, process));
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
