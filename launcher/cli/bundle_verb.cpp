// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "common/version.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/run/emulation.hpp"
#include "launcher/run/run_plan.hpp"
#include "launcher/scenario/installation.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <memory>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace::cli {
namespace {

namespace fs = std::filesystem;
using namespace launcher;

constexpr std::string_view kConfigFile = "config.yaml";

struct BundleArguments {
    ScenarioArguments scenario;
    std::string process, arch{"arm64"};
    fs::path out{"."};
};

/// Runs a program to its end; its exit code.
int run_and_wait(std::vector<std::string> words) {
    std::vector<char*> arguments;
    for (std::string& word : words) {
        arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    pid_t const pid = ::fork();
    if (pid == 0) {
        ::execvp(arguments[0], arguments.data());
        ::_exit(127);
    }
    int status = 0;
    ::waitpid(pid, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// "mgmt0 02:… 10.254.0.4/24" for each interface of the host.
std::string network_of(RunPlan const& plan, std::string const& host) {
    std::string text;
    for (Port const& port : plan.ports) {
        if (port.host == host) {
            text += fmt::format("{} {} {}\n", port.interface, port.mac,
                                port.address.empty() ? "-" : fmt::format("{}/{}", port.address, port.prefix));
        }
    }
    return text;
}

/// Copies every file that the configuration names into `folder`, where the configuration is, and names it as it is
/// called there: the bundle may be unpacked anywhere. `taken`: by name.
Result<void> take_along(config::Node& node, fs::path const& folder, std::map<std::string, fs::path>& taken) {
    for (config::Node& item : node.items) {
        if (auto ok = take_along(item, folder, taken); !ok) {
            return ok;
        }
    }
    for (config::Node::Entry& entry : node.entries) {
        if (auto ok = take_along(entry.value, folder, taken); !ok) {
            return ok;
        }
    }
    fs::path const file{node.text};
    std::error_code error;
    // What the kernel shows as a file belongs to the machine.
    if (!node.is_scalar() || !file.is_absolute() || node.text.starts_with("/proc/") ||
        !fs::is_regular_file(file, error)) {
        return {};
    }
    std::string const name = file.filename().string();
    auto const [it, first] = taken.try_emplace(name, file);
    if (name == kConfigFile || name == "network" || (!first && it->second != file)) {
        return fail(ExitCode::usage,
                    fmt::format("'{}' cannot be called {} in the bundle: another file is", file.string(), name),
                    "rename one");
    }
    if (first && !fs::copy_file(file, folder / name, error)) {
        return fail(ExitCode::environment, fmt::format("cannot copy '{}': {}", file.string(), error.message()));
    }
    node.text = name;
    node.quoted = true;
    return {};
}

/// The program of a process that a board can take, made for the board's processor.
Result<fs::path> program_for_board(PlannedProcess const& process, std::string const& arch) {
    bool const recorder = process.program == "gridspace-recorder";
    if (process.is_foreign || process.is_simulator || recorder || process.program == "gridspace-monitor") {
        return fail(ExitCode::usage,
                    fmt::format("process '{}' ({}) is nothing for a board{}", process.name, process.program,
                                recorder ? ": its recording belongs into the run's folder" : ""),
                    "agents, gateways and link process are");
    }
    fs::path program = arch == "arm64" ? arm64_files().programs / process.program : program_file(process.program);
    std::string const machine = machine_of(program), wanted = arch == "arm64" ? "ARM64" : "x86-64";
    if (machine != wanted) {
        return fail(ExitCode::environment,
                    machine.empty()
                        ? fmt::format("there is no {} for {} ({})", process.program, arch, program.string())
                        : fmt::format("'{}' is a program for {}, not for {}", program.string(), machine, wanted),
                    arch == "arm64" ? "./gridspace arm64 build makes it" : "is Gridspace built completely?");
    }
    return program;
}

int bundle(BundleArguments const& a) {
    auto const scenario = load(a.scenario);
    if (!scenario) {
        return static_cast<int>(ExitCode::usage);
    }
    PlanOptions options;
    options.folder = fs::absolute(a.out);
    RunPlan plan = make_plan(*scenario, options);
    auto const it = std::find_if(plan.processes.begin(), plan.processes.end(),
                                 [&](PlannedProcess const& p) { return p.name == a.process; });
    if (it == plan.processes.end()) {
        std::vector<std::string> names;
        for (PlannedProcess const& process : plan.processes) {
            names.push_back(process.name);
        }
        return print_error({ExitCode::usage,
                            fmt::format("scenario '{}' has no process '{}'", scenario->name, a.process),
                            fmt::format("there are: {}", join(names, ", "))});
    }
    auto const program = program_for_board(*it, a.arch);
    if (!program) {
        return print_error(program.error());
    }
    // A board is switched on whenever that may be, and waits.
    it->config.find("bus")->find("clock")->set("start_timeout_s", config::Node::scalar("0"));
    std::error_code error;
    fs::create_directories(a.out, error);
    fs::path const stage = fs::absolute(a.out) / fmt::format(".bundle-{}-{}", it->name, ::getpid());
    fs::path const conf = stage / "conf";
    fs::create_directories(conf, error);
    auto const unwritable = [&] {
        return print_error({ExitCode::environment, fmt::format("cannot write into '{}'", a.out.string()),
                            "--out names another folder"});
    };
    if (error) {
        return unwritable();
    }
    std::map<std::string, fs::path> taken;
    if (auto const ok = take_along(it->config, conf, taken); !ok) {
        fs::remove_all(stage, error);
        return print_error(ok.error());
    }
    std::ofstream{conf / kConfigFile} << to_yaml(it->config);
    std::ofstream{conf / "network"} << network_of(plan, it->host);
    if (!fs::exists(conf / kConfigFile)) {
        return unwritable();
    }
    fs::path const share = qos_file("member").parent_path().parent_path(); // source tree or share/gridspace
    fs::path const libraries = a.arch == "arm64" ? arm64_files().root : fs::path{"/"};
    int const code = run_and_wait({"sh", (share / "scripts/board/bundle.sh").string(), it->name, a.arch,
                                   program->string(), stage.string(), libraries.string(), fs::absolute(a.out).string(),
                                   std::string{gridspace::version().version}});
    fs::remove_all(stage, error);
    return code;
}

} // namespace

void add_bundle(Command app, Action& action) {
    auto const a = std::make_shared<BundleArguments>();
    Command verb =
        app.add_subcommand("bundle", "pack one process of a scenario for a board: tarball and Debian package");
    verb.add_option("SCENARIO", a->scenario.file, "scenario file").required();
    verb.add_option("PROCESS", a->process, "name of the process").required();
    verb.add_option("--arch", a->arch, "arm64 or amd64").check(one_of({"arm64", "amd64"}));
    verb.add_option("--out", a->out, "folder for the two files (default: this one)");
    verb.add_option("--set", a->scenario.set, "override a value: --set clock.tick_s=0.25 (may be repeated)").repeated();
    verb.callback([a, &action] { action = [a] { return bundle(*a); }; });
}

} // namespace gridspace::cli
