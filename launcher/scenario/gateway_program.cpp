// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-gateway, as the launcher sees it: its table checked against the scenario.
#include "bus/topics.hpp"
#include "gateways/gateway/gateway_declaration.hpp"
#include "launcher/scenario/declared_program.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_programs.hpp"
#include "launcher/scenario/wire_use.hpp"

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using gateways::Route;

class GatewaySettings final : public DeclaredSettings {
  public:
    explicit GatewaySettings(Fields& f) : DeclaredSettings{gateways::gateway_declaration()} { describe(f, config_); }

    void settle(Scenario const& s, Process const&) override {
        declare(gateways::declaration(config_, {}, context_of(s)));
    }
    void check(Scenario const& s, Process const& process, Diagnostics& diagnostics) override {
        check_raw_link(s, process, diagnostics);
        std::vector<Route> const routes = gateways::make_routes(config_, s.streams, bus::idl_of_type, diagnostics);
        declare(gateways::declaration(config_, routes, context_of(s))); // what is watched is known now
        for (Route const& route : routes) {
            if (route.to_samples()) {
                check_samples_on_steps(s, *route.to_stream, route.config.to.stream, diagnostics);
            }
        }
    }

  private:
    gateways::GatewayConfig config_;
};

} // namespace

std::unique_ptr<ProcessSettings> read_gateway(Fields& f) {
    return std::make_unique<GatewaySettings>(f);
}

} // namespace gridspace::launcher
