// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/graph/graph_model.hpp"

#include <optional>
#include <string>

namespace gridspace::graph {

[[nodiscard]] std::string to_json(Snapshot const& graph);
/// What `to_json` wrote (but for the ids of participants); nothing for any other text.
[[nodiscard]] std::optional<Snapshot> from_json(std::string const& text);
/// For Graphviz. `framework`: with the topics of the framework itself.
[[nodiscard]] std::string to_dot(Snapshot const& graph, bool framework);
/// A picture of its own: writers, topics and streams, readers in three columns.
[[nodiscard]] std::string to_svg(Snapshot const& graph, bool framework);

} // namespace gridspace::graph
