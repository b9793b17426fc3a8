// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/score/truth.hpp"

#include "common/config/yaml.hpp"

#include <fmt/format.h>
#include <set>

namespace gridspace::score {

Extent extent_of(std::vector<streams::Stream> const& streams, double simulated_s) {
    Extent out;
    for (streams::Stream const& stream : streams) {
        if (stream.kind == streams::Kind::smv && !stream.broken) {
            out.rates_hz[stream.name.name] = stream.rate_hz.to_double();
            out.names[stream.sv_id] = stream.name.name;
        }
    }
    out.end_s = simulated_s;
    return out;
}

Result<Truth> read_truth(std::filesystem::path const& run, double simulated_s) {
    config::Diagnostics diagnostics;
    std::vector<streams::Stream> streams;
    launcher::AttackSpans spans{config::Node::map()};
    if (auto scenario = config::load_yaml(run / "scenario.resolved.yaml", diagnostics)) {
        spans = launcher::AttackSpans{*scenario};
        if (config::Node const* const all = scenario->find("streams")) {
            streams = streams::read_streams(*all, diagnostics);
        }
    }
    if (!diagnostics.ok()) {
        return fail(ExitCode::usage, diagnostics.render());
    }
    Truth out;
    out.extent = extent_of(streams, simulated_s);
    std::set<std::string> attacked;
    auto const read = launcher::read_attack_labels(run / "data.mcap", [&](auto const& label) {
        spans.add(label);
        if (out.extent.rates_hz.contains(label.target)) {
            attacked.insert(label.target);
            out.labels.push_back(label);
        } else {
            ++out.messages_not_judged[label.attack];
        }
    });
    if (!read) {
        return std::unexpected{read.error()};
    }
    out.extent.only_stream = attacked.size() == 1 ? *attacked.begin() : "";
    out.attacks = spans.all();
    if (out.attacks.empty()) {
        return fail(ExitCode::usage,
                    fmt::format("'{}' holds no label of an attack: there is no truth to judge by", run.string()),
                    "a run with `attacks:`, whose attacker has `labels:`, and with `record: {samples: all}`");
    }
    return out;
}

} // namespace gridspace::score
