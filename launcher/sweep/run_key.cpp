// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/run_key.hpp"

#include "common/config/merge.hpp"
#include "common/version.hpp"
#include "launcher/folder/sha256.hpp"
#include "launcher/run/run_plan.hpp"
#include "launcher/scenario/installation.hpp"

#include <fmt/format.h>

namespace gridspace::launcher {

namespace fs = std::filesystem;

RunKeys::RunKeys(std::vector<fs::path> const& depends_on) {
    add_file(program_file("gridspace"), always_);
    std::error_code ignored;
    for (fs::path const& path : depends_on) {
        if (fs::is_directory(path, ignored)) {
            fs::recursive_directory_iterator entry{path, fs::directory_options::skip_permission_denied, ignored};
            for (; entry != fs::recursive_directory_iterator{}; entry.increment(ignored)) {
                add_file(entry->path(), always_);
            }
        } else {
            add_file(path, always_);
        }
    }
}

void RunKeys::add_file(fs::path const& file, std::map<std::string, std::string>& files) {
    auto [known, is_new] = hashes_.try_emplace(file.string());
    std::error_code ignored;
    if (is_new && fs::is_regular_file(file, ignored)) {
        known->second = sha256_of(file);
    }
    if (!known->second.empty()) {
        files.insert(*known);
    }
}

/// A text that is the name of a file may be one: a file too many only means that a run is done once more.
void RunKeys::add_files(config::Node const& node, std::map<std::string, std::string>& files) {
    if (node.is_scalar() && !node.text.empty() && node.text.size() < 1024 &&
        node.text.find('\n') == std::string::npos) {
        fs::path const base = node.where.source == nullptr ? "." : node.where.source->directory;
        add_file(fs::absolute(base / node.text).lexically_normal(), files);
    }
    for (config::Node::Entry const& entry : node.entries) {
        add_files(entry.value, files);
    }
    for (config::Node const& item : node.items) {
        add_files(item, files);
    }
}

std::string RunKeys::key_of(Scenario const& scenario) {
    std::map<std::string, std::string> files = always_;
    config::Node resolved = scenario.resolved;
    for (char const* shown : {"report", "notes", "description", "published"}) {
        resolved.erase(shown);
    }
    Version const& v = version();
    std::string text = fmt::format("gridspace sweep 1\n{} {} {} {}\n{}\n", v.version, v.commit, v.build_type,
                                   v.compiler, to_yaml(resolved));
    add_files(resolved, files);
    add_file(scenario.simulation.network, files);
    config::Diagnostics known; // the scenario was checked with it
    if (scenario.simulation.network.extension() != ".m") {
        if (auto const network = config::load_extended(scenario.simulation.network, known)) {
            text += to_yaml(*network) + "\n";
            add_files(*network, files);
        }
    }
    for (PlannedProcess const& process : make_plan(scenario, {.folder = "RUN"}).processes) {
        text += fmt::format("{}: {}\n", process.name, to_yaml(process.config));
        add_files(process.config, files);
        for (std::string const& word : process.command) {
            text += word + "\n";
            add_file(word, files);
        }
        for (auto const& [name, value] : process.environment) {
            text += fmt::format("{}={}\n", name, value);
        }
    }
    for (auto const& [file, hash] : files) {
        text += fmt::format("{} {}\n", hash, file);
    }
    return sha256_of_text(text).substr(0, 16);
}

} // namespace gridspace::launcher
