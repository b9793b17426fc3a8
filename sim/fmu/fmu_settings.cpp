// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/fmu/fmu_settings.hpp"

namespace gridspace::sim {
namespace {

void names(config::Fields& f, std::string_view key, std::vector<std::string>& out, std::string_view doc) {
    std::vector<config::Ref> refs;
    f.references(key, refs, {.doc = doc});
    for (config::Ref& ref : refs) {
        out.push_back(std::move(ref.name));
    }
}

config::Node list(std::vector<std::string> const& names) {
    config::Node out = config::Node::sequence();
    for (std::string const& name : names) {
        out.items.push_back(config::Node::quoted_text(name));
    }
    return out;
}

} // namespace

void describe(config::Fields& f, FmuSettings& s) {
    f.text("token", s.token, {.doc = "instantiationToken of the description", .required = true});
    f.file("network", s.network, {.doc = "network file", .required = true});
    describe(f, s.engine);
    names(f, "inputs", s.inputs, "variables that may be set, by value reference from 1");
    names(f, "outputs", s.outputs, "signals, by value reference behind the inputs");
}

std::string to_yaml(FmuSettings const& s) {
    using config::Node;
    Node out = Node::map();
    out.set("token", Node::quoted_text(s.token));
    out.set("network", Node::quoted_text(s.network.string()));
    out.set("solver", Node::scalar(s.engine.waveform() ? "emt" : "phasor"));
    out.set("step_s", Node::scalar(s.engine.step_s.to_string()));
    out.set("integration", Node::scalar(s.engine.fixed_step ? "fixed_step" : "adaptive"));
    out.set("threads", Node::scalar(std::to_string(s.engine.threads)));
    out.set("epoch", Node::quoted_text(s.engine.epoch));
    out.set("inputs", list(s.inputs));
    out.set("outputs", list(s.outputs));
    return config::to_yaml(out);
}

} // namespace gridspace::sim
