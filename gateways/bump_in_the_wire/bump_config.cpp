// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/bump_in_the_wire/bump_config.hpp"

#include "gateways/ethernet/boxed_ip.hpp"

namespace gridspace::gateways {
namespace {

void describe_way(config::Fields& f, std::string_view key, std::string_view doc, std::optional<BumpConfig::Way>& way) {
    f.object(key, {.doc = doc}, [&](config::Fields& w) {
        way.emplace();
        w.text("in", way->in, {.doc = "name of the piece of cable from which frames come", .required = true});
        w.text("out", way->out,
               {.doc = "and of the one on which they go on; empty: they pass untouched, and are heard"});
        bool smv = false, goose = false, ip = false;
        w.flag("smv", smv, {.doc = "sampled values travel there"});
        w.flag("goose", goose, {.doc = "GOOSE messages travel there"});
        w.flag("ip", ip, {.doc = "IP of programs in simulated time travels there"});
        if (smv) {
            way->ethertypes.push_back(iec61850::kSvEthertype);
        }
        if (goose) {
            way->ethertypes.push_back(iec61850::kGooseEthertype);
        }
        if (ip) {
            way->ethertypes.push_back(ethernet::kIpEthertype);
        }
    });
}

} // namespace

void describe_bumps(config::Fields& f, std::vector<BumpConfig>& bumps) {
    f.list("bumps", {.doc = "its places in cables; filled in by `gridspace run`"}, [&](config::Fields& c) {
        BumpConfig out;
        c.text("host", out.host, {.doc = "host at the one end", .required = true});
        c.text("link", out.link, {.doc = "switch at the other end", .required = true});
        c.text("host_interface", out.host_interface, {.doc = "interface towards the host", .required = true});
        c.text("switch_interface", out.switch_interface, {.doc = "interface towards the switch", .required = true});
        describe_way(c, "from_host", "frames that the host sends", out.from_host);
        describe_way(c, "to_host", "frames that the host receives", out.to_host);
        bumps.push_back(std::move(out));
    });
}

} // namespace gridspace::gateways
