// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/wire_timing.hpp"

#include "launcher/judge/signal_rows.hpp"

namespace gridspace::launcher {

using config::Node;

WireTiming measure_wire_timing(Results const& r, Node const& scenario) {
    WireTiming out;
    out.lockstep = r.mode == "lockstep";
    for (ProtectionChain const& chain : protection_chains(scenario)) {
        for (ProtectionChain::End const& end : chain.ends) {
            if (series_of(r.signals, "stream." + end.stream + ".received") != nullptr) {
                out.smv.push_back(smv_timing(r, scenario, end.stream));
            }
        }
        if (auto goose = goose_timing(r.signals, chain.trip_stream); goose.messages > 0) {
            out.goose.push_back(std::move(goose));
        }
        out.relays.push_back(relay_timing(r, scenario, chain));
    }
    for (ProtectionChain const& chain : foreign_chains(scenario)) {
        out.relays.push_back(foreign_timing(r, scenario, chain));
    }
    for (std::string const& name : uncounted_streams(r, scenario)) {
        auto const take = [&](auto captured, auto& timings) {
            if (captured) {
                timings.push_back(std::move(*captured));
            } else {
                out.not_seen.push_back(name);
            }
        };
        if (is_goose(scenario, name)) {
            take(captured_goose(r, scenario, name), out.goose);
        } else {
            take(captured_smv(r, scenario, name), out.smv);
        }
    }
    return out;
}

} // namespace gridspace::launcher
