// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/study_check.hpp"

#include "common/config/merge.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <map>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Node;

constexpr std::string_view kNetworkChanges = "simulation.network_changes.";

struct Missing {
    std::size_t part{0};           ///< of the path: the first that is not there
    std::vector<std::string> keys; ///< that are there in its place
};

/// How far a path leads into a tree; nothing when it leads to a value.
std::optional<Missing> missing_part(Node const& root, std::vector<std::string> const& path) {
    Node const* at = &root;
    for (std::size_t i = 0; i < path.size(); ++i) {
        Node const* const next = at->find(path[i]);
        if (next == nullptr) {
            Missing missing{i, {}};
            for (Node::Entry const& entry : at->entries) {
                missing.keys.push_back(entry.key);
            }
            return missing;
        }
        at = next;
    }
    return std::nullopt;
}

/// The last part may be a key that nobody has written yet: whether it exists is found when a run is loaded with it.
/// What it stands in must be there, and what is removed too.
void check_path(std::string const& written, config::SourceMark const& where, bool removes, BaseScenario const& base,
                Diagnostics& diagnostics) {
    bool const network = written.starts_with(kNetworkChanges) && base.network;
    std::string const own = network ? written.substr(kNetworkChanges.size()) : written;
    std::vector<std::string> const path = split(own, '.');
    if (std::any_of(path.begin(), path.end(), [](std::string const& part) { return part.empty(); })) {
        diagnostics.error(where, fmt::format("'{}' is not a path", written),
                          "keys joined by dots: processes.ev1.requested_h", static_cast<int>(written.size()));
        return;
    }
    std::optional<Missing> closest;
    for (Node const* tree : network ? std::vector<Node const*>{&*base.network}
                                    : std::vector<Node const*>{&base.scenario->resolved, &base.written}) {
        auto missing = missing_part(*tree, path);
        if (!missing || (missing->part + 1 == path.size() && !removes)) {
            return;
        }
        if (!closest || missing->part > closest->part) {
            closest = std::move(missing);
        }
    }
    std::vector<std::string> const there{path.begin(), path.begin() + static_cast<std::ptrdiff_t>(closest->part)};
    diagnostics.error(where,
                      fmt::format("{} has no '{}'{}", network ? "the network" : "the scenario", path[closest->part],
                                  there.empty() ? "" : fmt::format(" in {}", join(there, "."))),
                      spelling_hint(path[closest->part], closest->keys,
                                    network ? "" : "elements of the network are set as simulation.network_changes.…"),
                      static_cast<int>(written.size()));
}

/// Tables of SQL do not tell V from v.
std::string folded(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

void check_names(Study const& study, Scenario const& base, Diagnostics& diagnostics) {
    std::map<std::string, std::string> taken;
    for (std::string_view const name : kTableColumns) {
        taken.emplace(name, "every table has a column of that name");
    }
    auto const take = [&](std::string const& name, config::SourceMark const& where, std::string what) {
        auto const [known, is_new] = taken.emplace(folded(name), std::move(what));
        if (!is_new) {
            diagnostics.error(where, fmt::format("the name '{}' is taken: {}", name, known->second), "choose another",
                              static_cast<int>(name.size()));
        }
    };
    for (Parameter const& p : study.parameters) {
        take(p.name.name, p.name.where, "it is a parameter");
    }
    std::vector<std::string> expectations;
    for (Node::Entry const& entry : base.expect.entries) {
        expectations.push_back(entry.key);
        take(entry.key, study.scenario_mark, "the scenario has an expectation of that name");
    }
    for (Node::Entry const& entry : study.results.entries) {
        take(entry.key, entry.where, "it is a result");
    }
    std::vector<std::string> wanted;
    for (Ref const& name : study.expectations.value_or(std::vector<Ref>{})) {
        auto const width = static_cast<int>(name.name.size());
        if (std::find(expectations.begin(), expectations.end(), name.name) == expectations.end()) {
            diagnostics.error(name.where, fmt::format("the scenario has no expectation '{}'", name.name),
                              spelling_hint(name.name, expectations, "it has none"), width);
        } else if (std::find(wanted.begin(), wanted.end(), name.name) != wanted.end()) {
            diagnostics.error(name.where, fmt::format("'{}' is there twice", name.name), "", width);
        }
        wanted.push_back(name.name);
    }
}

} // namespace

std::optional<BaseScenario> load_base(Study const& study, Diagnostics& diagnostics) {
    BaseScenario base;
    base.scenario = load_scenario(study.scenario, {}, diagnostics);
    Diagnostics known;
    auto written = config::load_extended(study.scenario, known);
    if (!base.scenario || !written) {
        diagnostics.error(study.scenario_mark,
                          fmt::format("the scenario '{}' cannot be run as it is", study.scenario.filename().string()),
                          "`gridspace validate` shows the same");
        return std::nullopt;
    }
    base.written = std::move(*written);
    if (base.scenario->simulation.network.extension() != ".m") {
        base.network = config::load_extended(base.scenario->simulation.network, known);
    }
    return base;
}

void check_study(Study const& study, BaseScenario const& base, Diagnostics& diagnostics) {
    for (Node::Entry const& entry : study.set.entries) {
        check_path(entry.key, entry.where, entry.value.is_null(), base, diagnostics);
    }
    for (Parameter const& p : study.parameters) {
        for (Ref const& path : p.paths) {
            check_path(path.name, path.where, false, base, diagnostics);
        }
    }
    check_names(study, *base.scenario, diagnostics);
}

} // namespace gridspace::launcher
