// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/schema/schema_pages.hpp"

#include <fmt/format.h>
#include <fstream>
#include <memory>

namespace gridspace::cli {
namespace {

/// Writes configs/schema/*.json, docs/reference/config.md and actions.md below `root`.
int schema(std::filesystem::path const& root) {
    std::error_code ignored;
    std::filesystem::create_directories(root / "configs/schema", ignored);
    for (auto const& [file, text] : {std::pair{"configs/schema/scenario.schema.json", launcher::scenario_schema()},
                                     {"configs/schema/network.schema.json", launcher::network_schema()},
                                     {"configs/schema/router.schema.json", launcher::router_schema()},
                                     {"configs/schema/study.schema.json", launcher::study_schema()},
                                     {"configs/schema/certify.schema.json", launcher::certify_schema()},
                                     {"docs/reference/config.md", launcher::config_page()},
                                     {"docs/reference/actions.md", launcher::actions_page()}}) {
        std::ofstream stream{root / file, std::ios::trunc};
        stream << text;
        stream.close();
        if (!stream) {
            return print_error({ExitCode::environment, fmt::format("cannot write '{}'", (root / file).string()), ""});
        }
    }
    return 0;
}

} // namespace

void add_schema(Command app, Action& action) {
    auto const root = std::make_shared<std::filesystem::path>();
    Command verb =
        app.add_subcommand("schema", "write the JSON schemas and the reference page of the configuration files");
    verb.add_option("--write", *root, "root of the source tree").required();
    verb.hide();
    verb.callback([root, &action] { action = [root] { return schema(*root); }; });
}

} // namespace gridspace::cli
