// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What the launcher's verbs read: scenarios, routers, models, and the folders of runs.
#include "common/config/yaml.hpp"
#include "common/source_tree.hpp"
#include "ids/data/recording_file.hpp"
#include "ids/forecaster/model_file.hpp"
#include "launcher/ids/score/verdicts_file.hpp"
#include "launcher/judge/results.hpp"
#include "launcher/report/run_info.hpp"
#include "launcher/report/summary.hpp"
#include "launcher/scenario/scenario.hpp"
#include "monitor/graph/graph_text.hpp"
#include "router/router_config.hpp"
#include "sim/components/profile/profile_csv.hpp"
#include "targets.hpp"

#include <filesystem>
#include <fstream>
#include <string>

namespace gridspace::fuzz {
namespace {

/// For as long as the program runs: files are read by their names.
class Folder {
  public:
    Folder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "gridspace_fuzz_XXXXXX").string();
        require(::mkdtemp(pattern.data()) != nullptr, "no folder");
        path_ = pattern;
    }
    ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(Folder const&) = delete;
    Folder& operator=(Folder const&) = delete;
    [[nodiscard]] std::filesystem::path const& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

std::string text_of(std::uint8_t const* data, std::size_t size) {
    return {reinterpret_cast<char const*>(data), size};
}

void write(std::filesystem::path const& file, std::string const& text) {
    std::ofstream stream{file, std::ios::binary};
    stream << text;
    require(stream.flush().good(), "a file of the test cannot be written");
}

} // namespace

void scenario(std::uint8_t const* data, std::size_t size) {
    static Folder const folder;
    static std::filesystem::path const file = [] { // among those that it may extend, and beside their networks
        for (auto const& part : std::filesystem::directory_iterator{source_tree("configs")}) {
            if (part.path().filename() != "scenarios") {
                std::filesystem::create_directory_symlink(part.path(), folder.path() / part.path().filename());
            }
        }
        std::filesystem::create_directory(folder.path() / "scenarios");
        for (auto const& other : std::filesystem::directory_iterator{source_tree("configs/scenarios")}) {
            std::filesystem::create_symlink(other.path(), folder.path() / "scenarios" / other.path().filename());
        }
        return folder.path() / "scenarios" / "fuzzed.yaml";
    }();
    write(file, text_of(data, size));
    config::Diagnostics diagnostics;
    auto const scenario = launcher::load_scenario(file, {.start_programs = false}, diagnostics);
    require(scenario != nullptr || !diagnostics.ok(), "a scenario was refused without a word");
    (void)diagnostics.render();
}

void router(std::uint8_t const* data, std::size_t size) {
    std::string const text = text_of(data, size);
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("r.yaml", text), diagnostics);
    gridspace::router::RouterConfig config;
    if (root && root->is_map()) {
        config::read_fields(*root, "", diagnostics, [&](config::Fields& f) { describe(f, config); });
    }
    for (auto const& end : config.ends) {
        require(!diagnostics.ok() || !end.link || !end.link->listens || end.link->tls,
                "a router listens without knowing to whom");
    }
    (void)diagnostics.render();
}

void model(std::uint8_t const* data, std::size_t size) {
    if (auto const model = ids::model_from_json(text_of(data, size), "fuzz")) {
        auto const again = ids::model_from_json(ids::to_json(*model), "again");
        require(again && ids::model_hash(*again) == ids::model_hash(*model), "a model that we wrote is another one");
    }
}

void columns(std::uint8_t const* data, std::size_t size) {
    static Folder const folder;
    std::filesystem::path const csv = folder.path() / "x.csv", npy = folder.path() / "x.npy";
    write(csv, text_of(data, size));
    write(npy, text_of(data, size));
    if (auto const profile = sim::read_profile_csv(csv, "a")) {
        require(!profile->hours.empty() && profile->hours.size() == profile->values.size(), "half a profile");
    }
    for (auto const& file : {csv, npy}) {
        if (auto const currents = ids::read_recording(file, {4000, 60, {}})) {
            require(currents->to.empty() || currents->to.size() == currents->from.size(), "half a recording");
        }
    }
    config::Diagnostics diagnostics;
    score::Extent const extent{{{"SMV21", 4800}}, {{"MU21", "SMV21"}}, 2, "SMV21"};
    auto const verdicts = score::parse_verdicts(text_of(data, size), "x.csv", extent, 0.5, diagnostics);
    require(verdicts.has_value() == diagnostics.ok(), "no verdicts and no word about it");
    (void)diagnostics.render();
}

void graph(std::uint8_t const* data, std::size_t size) {
    if (auto const graph = gridspace::graph::from_json(text_of(data, size))) {
        (void)gridspace::graph::to_dot(*graph, true);
        require(gridspace::graph::to_svg(*graph, true).find("<script") == std::string::npos, "a name became markup");
        require(gridspace::graph::from_json(to_json(*graph)).has_value(), "a graph that we wrote cannot be read");
    }
}

void run_folder(std::uint8_t const* data, std::size_t size) {
    static Folder const folder;
    std::string const text = text_of(data, size);
    std::filesystem::create_directories(folder.path() / "report");
    for (char const* name : {"manifest.json", "report/summary.json", "events.ndjson", "scenario.resolved.yaml"}) {
        write(folder.path() / name, text);
    }
    auto const info = launcher::run_info(folder.path());
    auto const results = launcher::read_results(folder.path());
    require(info.has_value(), "a folder without a recording cannot be shown");
    require(info->text.find('\x1b') == std::string::npos, "a name reached the terminal as it is");
    if (!results) {
        require(results.error().message.find("manifest.json") != std::string::npos, "only a manifest is needed");
        return;
    }
    (void)launcher::summary_json(*results);
    (void)launcher::to_junit(*results);
    (void)launcher::to_text(*results, false);
}

} // namespace gridspace::fuzz
