// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace router CONFIG: gridspace-router takes the place of this process.
#include "launcher/cli/become.hpp"
#include "launcher/cli/verbs.hpp"

#include <memory>

#include <string>
#include <utility>
#include <vector>

namespace gridspace::cli {
namespace {

struct RouterArguments {
    std::filesystem::path config;
    bool check{false}, json{false};
};

int router(RouterArguments const& arguments) {
    std::vector<std::string> words{"--config", arguments.config.string()};
    if (arguments.check) {
        words.emplace_back("--check");
    }
    if (arguments.json) {
        words.emplace_back("--json");
        words.emplace_back("--log-level");
        words.emplace_back("warning");
    }
    return become("gridspace-router", "router", std::move(words));
}

} // namespace

void add_router(Command app, Action& action) {
    auto const a = std::make_shared<RouterArguments>();
    Command verb = app.add_subcommand("router", "carry topics between DDS domains and sites");
    verb.add_option("CONFIG", a->config, "ends and the topics that may pass (YAML)").required();
    verb.add_flag("--check", a->check, "check the configuration and end");
    verb.add_flag("--json", a->json, "what happens, as JSON lines on standard output");
    verb.callback([a, &action] { action = [a] { return router(*a); }; });
}

} // namespace gridspace::cli
