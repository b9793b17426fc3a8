// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/run_network.hpp"

#include "common/config/merge.hpp"
#include "common/config/yaml.hpp"
#include "launcher/judge/number_at.hpp"

#include <optional>
#include <string_view>

namespace gridspace::launcher {
namespace {

using config::Node;
namespace fs = std::filesystem;

std::optional<Node> map_of(fs::path const& file) {
    config::Diagnostics ignored; // the run was started with it
    auto node = fs::exists(file) ? config::load_yaml(file, ignored) : std::nullopt;
    return node && node->is_map() ? node : std::nullopt;
}

Node const* below(Node const* map, std::string_view key) {
    return map == nullptr ? nullptr : map->find(key);
}

} // namespace

Node network_of_run(fs::path const& run, Node const& scenario) {
    Node network = map_of(run / "network.yaml").value_or(Node::map());
    if (Node const* changes = below(scenario.find("simulation"), "network_changes");
        changes != nullptr && changes->is_map()) {
        config::merge(network, *changes);
    }
    return network;
}

double frequency_of_run(fs::path const& run) {
    auto const monitor = map_of(run / "monitor.yaml").value_or(Node::map());
    return number_at(below(monitor.find("settings"), "run"), "frequency_hz").value_or(60);
}

} // namespace gridspace::launcher
