// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/run_folder.hpp"

#include "common/lateness_json.hpp"
#include "launcher/folder/machine_latency.hpp"
#include "launcher/folder/sha256.hpp"
#include "launcher/folder/write_file.hpp"
#include "launcher/scenario/monitor_settings.hpp"

#include "common/config/merge.hpp"
#include "common/config/yaml.hpp"
#include "common/version.hpp"

#include <ctime>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <sys/utsname.h>
#include <thread>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

std::string utc_stamp() {
    std::time_t const now = std::time(nullptr);
    std::tm parts{};
    gmtime_r(&now, &parts);
    char text[32];
    std::strftime(text, sizeof text, "%Y%m%dT%H%M%SZ", &parts);
    return text;
}

/// A line "key : value" of /proc/cpuinfo.
std::string cpu_info(std::string_view key) {
    std::ifstream stream{"/proc/cpuinfo"};
    for (std::string line; std::getline(stream, line);) {
        if (line.starts_with(key)) {
            std::size_t const colon = line.find(": ");
            return colon == std::string::npos ? "" : line.substr(colon + 2);
        }
    }
    return "";
}

Json host_of(bool root) {
    utsname name{};
    uname(&name);
    return Json{{"kernel", fmt::format("{} {}", name.sysname, name.release)},
                {"machine", name.machine},
                {"cpu", cpu_info("model name")},
                {"cpu_flags", cpu_info("flags")},
                {"processors", std::thread::hardware_concurrency()},
                {"root", root}};
}

} // namespace

Result<fs::path> make_run_folder(std::string const& scenario, fs::path const& parent, fs::path const& exact) {
    std::error_code error;
    if (!exact.empty()) {
        if (fs::exists(exact, error) && !fs::is_empty(exact, error)) {
            return fail(ExitCode::usage, fmt::format("the folder '{}' is not empty", exact.string()),
                        "choose another one for --out");
        }
        fs::create_directories(exact, error);
        return error ? fail(ExitCode::environment, fmt::format("cannot make '{}': {}", exact.string(), error.message()),
                            "choose another one for --out")
                     : Result<fs::path>{fs::absolute(exact).lexically_normal()};
    }
    fs::create_directories(parent, error);
    std::string const name = fmt::format("{}-{}", scenario, utc_stamp());
    fs::path folder = parent / name;
    for (int n = 2; !fs::create_directory(folder, error); ++n) {
        if (error) {
            return fail(ExitCode::environment, fmt::format("cannot make '{}': {}", folder.string(), error.message()),
                        "--out names another folder");
        }
        folder = parent / fmt::format("{}-{}", name, n);
    }
    fs::path const fresh = parent / fmt::format(".latest-{}", ::getpid());
    fs::create_directory_symlink(folder.filename(), fresh, error);
    fs::rename(fresh, parent / "latest", error); // atomic: two runs may start at once
    return fs::absolute(folder).lexically_normal();
}

/// Every file that a process's configuration names (models, QoS), with its hash: other content is another run.
static void add_files(config::Node const& node, Json& files) {
    if (node.is_scalar() && node.text.starts_with('/')) {
        std::error_code error;
        if (fs::is_regular_file(node.text, error)) {
            files[node.text] = {{"sha256", sha256_of(node.text)}};
        }
    }
    for (config::Node::Entry const& entry : node.entries) {
        add_files(entry.value, files);
    }
    for (config::Node const& item : node.items) {
        add_files(item, files);
    }
}

/// The folder's network.yaml stands alone: whoever looks at the run follows no name out of it.
static Result<void> copy_network(fs::path const& file, fs::path const& folder) {
    fs::path const copy = folder / ("network" + file.extension().string());
    config::Diagnostics known; // the scenario was checked with it
    auto const own = file.extension() == ".m" ? std::nullopt : config::load_yaml(file, known);
    auto const whole = own && own->find("extends") != nullptr ? config::load_extended(file, known) : std::nullopt;
    if (whole) {
        return replace_file(copy, to_yaml(*whole));
    }
    std::error_code error;
    fs::copy_file(file, copy, fs::copy_options::overwrite_existing, error);
    return error ? fail(ExitCode::environment, fmt::format("cannot write '{}': {}", copy.string(), error.message()))
                 : Result<void>{};
}

Result<void> write_inputs(Scenario const& scenario, RunPlan const& plan, bool root) {
    std::error_code error;
    for (char const* name : {"processes", "logs", "report"}) {
        fs::create_directories(plan.folder / name, error);
    }
    Json processes = Json::object();
    for (PlannedProcess const& process : plan.processes) {
        if (auto ok = replace_file(process.config_file, to_yaml(process.config)); !ok) {
            return ok;
        }
        Json files = Json::object();
        add_files(process.config, files);
        processes[process.name] = {
            {"program", process.program}, {"host", process.host}, {"member", process.is_member}, {"files", files}};
    }
    if (auto ok = replace_file(plan.folder / "scenario.resolved.yaml", to_yaml(scenario.resolved)); !ok) {
        return ok;
    }
    if (auto ok = replace_file(plan.folder / "monitor.yaml", to_yaml(recorded_monitor(scenario))); !ok) {
        return ok;
    }
    if (auto ok = copy_network(scenario.simulation.network, plan.folder); !ok) {
        return ok;
    }
    Version const& v = version();
    Json manifest{
        {"scenario", scenario.name},
        {"description", scenario.description},
        {"started", utc_stamp()},
        {"gridspace",
         {{"version", v.version}, {"commit", v.commit}, {"build", v.build_type}, {"compiler", v.compiler}}},
        {"seed", scenario.seed},
        {"clock",
         {{"mode", scenario.clock.mode == bus::ClockMode::lockstep ? "lockstep" : "realtime"},
          {"speed", scenario.clock.speed == 0 ? Json("max") : Json(scenario.clock.speed)},
          {"tick_s", scenario.tick_s().to_string()},
          {"step_s", scenario.simulation.step_s.to_string()},
          {"epoch", scenario.simulation.epoch}}},
        {"deterministic",
         scenario.clock.mode ==
             bus::ClockMode::lockstep}, // a member that dies or is late ends a run, so nothing else spoils it
        {"duration_s", plan.duration_s},
        {"files",
         {{"scenario", {{"path", scenario.file.string()}, {"sha256", sha256_of(scenario.file)}}},
          {"network",
           {{"path", scenario.simulation.network.string()}, {"sha256", sha256_of(scenario.simulation.network)}}}}},
        {"processes", processes},
        {"isolation", plan.namespaces
                          ? (root ? "network, mount and PID namespaces" : "user, network, mount and PID namespaces")
                          : "none: loopback interface, own DDS domains"},
        {"scheduling", plan.scheduling},
        {"idle_processors", plan.processors},
        {"host", host_of(root)},
    };
    if (scenario.clock.mode == bus::ClockMode::realtime) {
        if (auto const machine = kept_machine_latency()) {
            manifest["machine_latency"] = *machine;
        }
    }
    return replace_file(plan.folder / "manifest.json", manifest.dump(2) + "\n");
}

Result<void> write_outcome(fs::path const& folder, RunOutcome const& outcome) {
    std::ifstream stream{folder / "manifest.json"};
    Json manifest = Json::parse(stream, nullptr, false);
    if (!manifest.is_object()) {
        manifest = Json::object();
    }
    manifest["exit"] = outcome.exit_code;
    manifest["cause"] = outcome.cause;
    manifest["simulated_s"] = outcome.simulated_s;
    manifest["wall_s"] = outcome.wall_s;
    manifest["overruns"] = outcome.overruns;
    if (outcome.ticks) {
        manifest["ticks"] = to_json(*outcome.ticks);
    }
    for (RunOutcome::ProcessEnd const& end : outcome.ends) {
        manifest["processes"][end.process]["exit"] = end.code;
        manifest["processes"][end.process]["end"] = end.how;
        manifest["processes"][end.process]["cpu_s"] = end.cpu_s;
    }
    return replace_file(folder / "manifest.json", manifest.dump(2) + "\n");
}

} // namespace gridspace::launcher
