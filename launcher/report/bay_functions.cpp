// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/bay_functions.hpp"

#include "agents/relay/functions/function_config.hpp"
#include "common/text.hpp"
#include "launcher/judge/protection_chain.hpp"
#include "launcher/report/series.hpp"

namespace gridspace::launcher {

std::vector<BayFunctions> bay_functions(config::Node const& scenario, std::string const& pattern) {
    std::vector<BayFunctions> out;
    config::Node const* const processes = scenario.find("processes");
    for (ProtectionChain const& chain : protection_chains(scenario)) {
        config::Node const* const functions = processes->find(chain.relay)->find("functions");
        if (functions == nullptr || !matches_glob(pattern, chain.relay)) {
            continue;
        }
        config::Diagnostics said; // before the run
        relay::FunctionContext context;
        context.inputs = relay::kCurrents | relay::kVoltages | relay::kBusVoltages;
        if (auto set = relay::make_functions(*functions, context, said)) {
            out.push_back({chain.relay, std::move(*set), chain.breakers()});
        }
    }
    return out;
}

std::optional<FunctionCourse> course_of(SignalStore const& signals, std::string const& relay,
                                        std::string const& function, double from_s, double to_s) {
    std::string const prefix = "relay." + relay + "." + function + ".";
    auto const start = rises(signals, prefix + "str", from_s, to_s);
    if (!start) {
        return std::nullopt;
    }
    FunctionCourse out{*start, rises(signals, prefix + "op", *start, to_s), {}};
    auto const& states = signals.at(prefix + "str");
    for (std::size_t i = 0; i < states.values.size() && !out.drop_s; ++i) {
        double const t = static_cast<double>(states.times_ns[i]) / 1e9;
        if (t > *start && t <= to_s && states.values[i] == 0) {
            out.drop_s = t;
        }
    }
    if (out.drop_s && out.operate_s && *out.drop_s < *out.operate_s) {
        out.operate_s.reset(); // that was another time
    }
    return out;
}

} // namespace gridspace::launcher
