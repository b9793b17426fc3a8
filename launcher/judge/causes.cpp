// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/causes.hpp"

#include "common/config/fields.hpp"
#include "launcher/judge/number_at.hpp"
#include "launcher/judge/run_network.hpp"

#include <set>
#include <vector>

namespace gridspace::launcher {
namespace {

using config::Node;

/// The lines at whose ends a relay's current transformers are, by the run's copy of the network file.
std::set<std::string> own_lines(std::filesystem::path const& run, Node const& scenario, ProtectionChain const& chain) {
    std::set<std::string> out;
    Node const network = network_of_run(run, scenario);
    Node const* transformers = network.find("cts");
    for (ProtectionChain::End const& end : chain.ends) {
        Node const* ct = transformers == nullptr ? nullptr : transformers->find(end.transformer);
        if (Node const* line = ct == nullptr ? nullptr : ct->find("line"); line != nullptr && line->is_scalar()) {
            out.insert(line->text);
        }
    }
    return out;
}

} // namespace

std::optional<Cause> cause_before(Node const& scenario, double until_s) {
    std::optional<Cause> out;
    bool is_fault = false;
    Node const* events = scenario.find("events");
    for (Node::Entry const& event : events == nullptr ? std::vector<Node::Entry>{} : events->entries) {
        Node const* at = event.value.find("at_s");
        double const time_s = at == nullptr ? until_s + 1 : config::number_of(*at).value_or(until_s + 1);
        bool const fault = event.value.find("apply_fault") != nullptr;
        if (time_s <= until_s && (fault || !is_fault) && (!out || time_s >= out->second || (fault && !is_fault))) {
            out = {event.key, time_s};
            is_fault = fault;
        }
    }
    return out;
}

std::optional<Cause> fault_on_own_line(std::filesystem::path const& run, Node const& scenario,
                                       ProtectionChain const& chain, double until_s) {
    std::set<std::string> const lines = own_lines(run, scenario, chain);
    constexpr double kLongS = 0.1;
    std::optional<Cause> out;
    Node const* events = scenario.find("events");
    for (Node::Entry const& event : events == nullptr ? std::vector<Node::Entry>{} : events->entries) {
        Node const* fault = event.value.find("apply_fault");
        Node const* line = fault == nullptr ? nullptr : fault->find("line");
        auto const at = number_at(&event.value, "at_s");
        if (line == nullptr || !lines.contains(line->text) || !at || *at > until_s || (out && *at < out->second)) {
            continue;
        }
        auto const stands_ms = number_at(&event.value, "clear_after_ms");
        if (!stands_ms || *at + *stands_ms / 1e3 + kLongS >= until_s) {
            out = {event.key, *at};
        }
    }
    return out;
}

} // namespace gridspace::launcher
