// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/folder/machine_latency.hpp"

#include "common/json_value.hpp"
#include "common/lateness_json.hpp"
#include "launcher/folder/write_file.hpp"

#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sys/utsname.h>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;

/// The folder that scripts/cache.sh takes, too; empty where the user has no home.
fs::path cache_folder() {
    for (auto const& [variable, below] :
         {std::pair{"GRIDSPACE_CACHE", ""}, {"XDG_CACHE_HOME", "gridspace"}, {"HOME", ".cache/gridspace"}}) {
        if (char const* folder = std::getenv(variable); folder != nullptr && *folder != '\0') {
            return fs::path{folder} / below;
        }
    }
    return {};
}

std::string this_machine() {
    utsname name{};
    ::uname(&name);
    return fmt::format("{} {} {}", name.nodename, name.release, name.version);
}

} // namespace

Result<fs::path> keep_machine_latency(nlohmann::ordered_json const& measured) {
    fs::path const folder = cache_folder();
    std::error_code error;
    if (folder.empty() || (fs::create_directories(folder, error), error)) {
        return fail(ExitCode::environment,
                    fmt::format("no cache folder for it: {}", folder.empty() ? "HOME is not set" : error.message()));
    }
    nlohmann::ordered_json kept = measured;
    kept["machine"] = this_machine();
    if (auto ok = replace_file(folder / "latency.json", kept.dump(2) + "\n"); !ok) {
        return std::unexpected{ok.error()};
    }
    return folder / "latency.json";
}

std::optional<nlohmann::ordered_json> kept_machine_latency() {
    fs::path const folder = cache_folder();
    std::ifstream stream{folder / "latency.json"};
    auto kept = nlohmann::ordered_json::parse(stream, nullptr, false);
    if (folder.empty() || !kept.is_object() || text_of(kept, "machine") != this_machine()) {
        return std::nullopt;
    }
    kept.erase("machine");
    return kept;
}

std::optional<MachineLatency> machine_latency_of(nlohmann::ordered_json const& kept) {
    MachineLatency out{text_of(kept, "measured"), text_of(kept, "load"), {}};
    nlohmann::ordered_json const ways = value_of(kept, "ways", nlohmann::ordered_json::array());
    for (auto const& way : ways.is_array() ? ways : nlohmann::ordered_json::array()) {
        if (auto const lateness = lateness_of(way)) {
            out.ways.push_back({text_of(way, "name"), *lateness});
        }
    }
    return out.ways.empty() ? std::nullopt : std::optional{out};
}

} // namespace gridspace::launcher
