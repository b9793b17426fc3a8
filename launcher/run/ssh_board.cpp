// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/ssh_board.hpp"

#include "common/text.hpp"
#include "launcher/run/emulation.hpp"
#include "launcher/scenario/installation.hpp"
#include "launcher/scenario/limited_command.hpp"

#include <cstdlib>
#include <fmt/format.h>
#include <unistd.h>
#include <utility>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

constexpr std::string_view kCable = "gridspace-cable";
constexpr seconds kConnect{20}, kCopy{300}, kCheck{30};
constexpr std::string_view kBundles = ".cache/gridspace"; // in the home directory of the board's user

fs::path board_script(std::string_view name) {
    return qos_file("member").parent_path().parent_path() / "scripts/board" / name; // source tree or share/gridspace
}

/// Never asks anything; notices a connection that is gone.
std::vector<std::string> ssh_words(RunOn const& on, SshSettings const& ssh) {
    std::vector<std::string> words{"ssh", "-T",
                                   "-o",  "BatchMode=yes",
                                   "-o",  "ConnectTimeout=10",
                                   "-o",  "ServerAliveInterval=5",
                                   "-o",  "ServerAliveCountMax=3",
                                   "-o",  "ForwardX11=no",
                                   "-o",  "ClearAllForwardings=yes"};
    if (!ssh.config.empty()) {
        words.insert(words.end(), {"-F", ssh.config.string()});
    }
    if (!ssh.identity.empty()) {
        words.insert(words.end(), {"-i", ssh.identity.string(), "-o", "IdentitiesOnly=yes"});
    }
    if (on.port > 0) {
        words.insert(words.end(), {"-p", std::to_string(on.port)});
    }
    if (!on.user.empty()) {
        words.insert(words.end(), {"-l", on.user});
    }
    words.insert(words.end(), {"--", on.host});
    return words;
}

/// What ssh means, in words of this program; its own last line otherwise.
Error ssh_error(std::string const& said) {
    std::string last;
    for (std::string const& line : split(said, '\n')) {
        last = trim(line).empty() ? last : std::string{trim(line)};
    }
    if (said.find("Host key verification failed") != std::string::npos) {
        return {ExitCode::environment, "its host key is not the known one, or not known yet",
                "ssh to it once by hand, or ssh-keyscan it into ~/.ssh/known_hosts"};
    }
    if (said.find("Permission denied") != std::string::npos ||
        said.find("Too many authentication failures") != std::string::npos) {
        return {ExitCode::environment, fmt::format("it refuses the key ({})", last),
                "ssh-copy-id, or `ssh: {identity: FILE}` of the process; no password is asked for"};
    }
    return {ExitCode::environment, fmt::format("it cannot be reached ({})", last.empty() ? "ssh says nothing" : last),
            "is it on, and is this its address? `ssh` by hand tells more"};
}

/// tar names every file that a full disk has not taken: it is the disk that matters, and how much it has to take.
Error with_space_needed(Error error, fs::path const& tree) {
    for (std::string_view const full : {"No space left on device", "Disk quota exceeded"}) {
        if (error.message.find(full) == std::string::npos) {
            continue;
        }
        std::uintmax_t octets = 0;
        for (fs::directory_entry const& entry : fs::recursive_directory_iterator{tree}) {
            octets += entry.is_regular_file() ? entry.file_size() : 0;
        }
        std::size_t const said = error.message.find("tar:");
        error.message = error.message.substr(0, said == std::string::npos ? error.message.find(full) : said);
        error.message += full;
        error.remedy = fmt::format("it needs {:.1f} MB in ~/{} there, where copies of older builds may be deleted",
                                   static_cast<double>(octets) / 1e6, kBundles);
    }
    return error;
}

/// The board of one process, being prepared.
class Board {
  public:
    Board(Process const& process, std::function<void(std::string_view)> const& note)
        : process_{process}, on_{parse_run_on(process.run_on).value_or(RunOn{})}, note_{note},
          ssh_{ssh_words(on_, process.ssh)} {}

    Result<std::string> prepare() {
        if (!process_.ssh.identity.empty() && ::access(process_.ssh.identity.c_str(), R_OK) != 0) {
            return failed("connection",
                          {ExitCode::environment,
                           fmt::format("the key '{}' cannot be read", process_.ssh.identity.string()), ""});
        }
        auto const machine = remote("connection", "uname -m", kConnect);
        if (!machine) {
            return std::unexpected{machine.error()};
        }
        auto bundle = process_.ssh.installed.empty() ? copy(std::string{trim(*machine)})
                                                     : Result<std::string>{process_.ssh.installed};
        if (!bundle) {
            return bundle;
        }
        auto const ok = check(*bundle, std::string{trim(*machine)});
        return ok ? bundle : std::unexpected{ok.error()};
    }

  private:
    std::unexpected<Error> failed(std::string_view step, Error error) const {
        error.message = fmt::format("process '{}': {} ({}): {}", process_.name.name, on_.place(), step, error.message);
        return std::unexpected{std::move(error)};
    }

    /// What a command on the board prints.
    Result<std::string> remote(std::string_view step, std::string const& command, seconds limit,
                               fs::path const& input = {}) const {
        std::vector<std::string> words = ssh_;
        words.push_back(command);
        auto const done = run_limited(words, limit, input);
        if (!done) {
            return failed(step, done.error());
        }
        if (done->timed_out) {
            return failed(step, {ExitCode::stall, fmt::format("not done after {} s", limit.count()),
                                 "is the connection very slow, or the board busy?"});
        }
        if (done->code == 255) {
            return failed(step, ssh_error(done->errors));
        }
        if (done->code != 0) {
            std::string const said{trim(done->errors)};
            return failed(step,
                          {ExitCode::environment, said.empty() ? fmt::format("exit code {}", done->code) : said, ""});
        }
        return done->output;
    }

    /// The folder on the board, relative to the user's home.
    Result<std::string> copy(std::string const& machine) const {
        bool const arm64 = machine == "aarch64" || machine == "arm64";
        if (!arm64 && machine != "x86_64") {
            return failed("copy",
                          {ExitCode::environment,
                           fmt::format("it is a '{}', and there are programs for aarch64 and x86_64 alone", machine),
                           "another board"});
        }
        Arm64Files const files = arm64_files();
        fs::path const folder = arm64 ? files.programs : program_file("gridspace").parent_path();
        fs::path const program = folder / process_.program.name;
        for (fs::path const& file : {program, folder / kCable}) {
            if (machine_of(file) != (arm64 ? "ARM64" : "x86-64")) {
                return failed("copy", {ExitCode::environment,
                                       fmt::format("there is no '{}' for {} ({})", file.filename().string(), machine,
                                                   file.string()),
                                       arm64 ? "./gridspace arm64 build makes it" : "is Gridspace built completely?"});
            }
        }
        std::string stage = (fs::temp_directory_path() / "gridspace-stage-XXXXXX").string();
        if (::mkdtemp(stage.data()) == nullptr) {
            return failed("copy", {ExitCode::environment,
                                   fmt::format("cannot write into {}", fs::temp_directory_path().string()), ""});
        }
        auto out = copy_staged(arm64, program, folder / kCable, arm64 ? files.root : fs::path{"/"}, stage);
        std::error_code ignored;
        fs::remove_all(stage, ignored);
        return out;
    }

    Result<std::string> copy_staged(bool arm64, fs::path const& program, fs::path const& cable, fs::path const& root,
                                    fs::path const& stage) const {
        fs::path const tree = stage / "tree", archive = stage / "bundle.tar.gz";
        auto const staged = run_limited({"sh", board_script("stage_program.sh").string(), arm64 ? "arm64" : "amd64",
                                         program.string(), cable.string(), root.string(), tree.string()},
                                        kCopy, {});
        if (!staged) {
            return failed("copy", staged.error());
        }
        if (staged->code != 0) {
            return failed("copy", {ExitCode::environment, std::string{trim(staged->errors)}, ""});
        }
        std::string name = fmt::format("{}/{}", kBundles, trim(staged->output));
        auto const there = remote("copy", fmt::format("test -d {} && echo there || echo missing", name), kCheck);
        if (!there) {
            return std::unexpected{there.error()};
        }
        if (trim(*there) == "there") {
            return name;
        }
        auto const packed = run_limited({"tar", "-C", tree.string(), "--owner=0", "--group=0", "-I", "gzip -1", "-cf",
                                         archive.string(), "bin", "lib"},
                                        kCopy, {});
        if (!packed) {
            return failed("copy", packed.error());
        }
        if (packed->code != 0) {
            return failed("copy", {ExitCode::environment, std::string{trim(packed->errors)}, ""});
        }
        note_(fmt::format("{}: copying {} and its libraries ({:.1f} MB)", on_.place(), process_.program.name,
                          static_cast<double>(fs::file_size(archive)) / 1e6));
        // Complete or not there at all, also when two runs copy at once.
        auto copied = remote("copy",
                             fmt::format("umask 077 && {{ mkdir -p {0}.$$ && tar -C {0}.$$ -xzf -; }} || "
                                         "{{ rm -rf {0}.$$; exit 1; }}; "
                                         "{{ mv -T {0}.$$ {0} 2>/dev/null || rm -rf {0}.$$; }} && test -d {0}",
                                         name),
                             kCopy, archive);
        if (!copied) {
            return std::unexpected{with_space_needed(copied.error(), tree)};
        }
        return name;
    }

    /// The program can be started there, and may do there what it has to.
    Result<void> check(std::string const& bundle, std::string const& machine) const {
        std::string const program = fmt::format("{}/bin/{}", bundle, process_.program.name);
        auto const version =
            remote("check", fmt::format("LD_LIBRARY_PATH={}/lib {} --version", bundle, program), kCheck);
        if (!version) {
            Error error = version.error();
            if (error.message.find("error while loading shared libraries") != std::string::npos) {
                error.remedy = fmt::format(
                    "a library is missing there: install it, or delete {} there, so that it is copied again", bundle);
            } else if (error.message.find("Exec format error") != std::string::npos ||
                       error.message.find("yntax error") != std::string::npos) { // some shells take it for a script
                error.remedy = fmt::format("it is for another processor than the board's ({})", machine);
            } else if (error.message.find("not found") != std::string::npos ||
                       error.message.find("No such file") != std::string::npos) {
                error.remedy = process_.ssh.installed.empty()
                                   ? "is the C library of the board that of Debian 12, or newer?"
                                   : "is a bundle of this process installed there? (`gridspace bundle`)";
            }
            return std::unexpected{std::move(error)};
        }
        auto const able = remote("check", fmt::format("{}/bin/{} check", bundle, kCable), kCheck);
        return able ? Result<void>{} : std::unexpected{able.error()};
    }

    Process const& process_;
    RunOn on_;
    std::function<void(std::string_view)> const& note_;
    std::vector<std::string> ssh_;
};

} // namespace

Result<BoardBundles> prepare_boards(Scenario const& scenario, std::function<void(std::string_view)> const& note) {
    BoardBundles bundles;
    for (Process const& process : scenario.processes) {
        if (parse_run_on(process.run_on).value_or(RunOn{}).kind != RunOn::Kind::ssh) {
            continue;
        }
        if (::geteuid() != 0 || ::access("/dev/net/tun", R_OK | W_OK) != 0) {
            return fail(ExitCode::environment,
                        fmt::format("process '{}': `run_on: ssh` plugs the board into the scenario's network by tap "
                                    "devices, for which it needs root and "
                                    "/dev/net/tun",
                                    process.name.name),
                        "run as root (modprobe tun, if the device is missing)");
        }
        if (system_program("ssh").empty()) {
            return fail(ExitCode::environment,
                        fmt::format("process '{}': the program `ssh` is missing", process.name.name),
                        "apt install openssh-client");
        }
        auto bundle = Board{process, note}.prepare();
        if (!bundle) {
            return std::unexpected{bundle.error()};
        }
        bundles[process.name.name] = std::move(*bundle);
    }
    return bundles;
}

std::vector<std::string> ssh_board_command(std::vector<std::string> const& command, fs::path const& config_file,
                                           Process const& process, std::string const& bundle,
                                           std::vector<Port> const& ports, double member_timeout_s) {
    RunOn const on = parse_run_on(process.run_on).value_or(RunOn{});
    // Before the simulator's own patience with its members ends: it would not know why.
    std::vector<std::string> words{"sh",       board_script("start_ssh.sh").string(), program_file(kCable).string(),
                                   on.place(), shortest(0.6 * member_timeout_s),      config_file.string()};
    for (Port const& port : ports) {
        if (port.host == process.host.name) {
            words.push_back(fmt::format("{},{},{}", port.interface, port.mac,
                                        port.address.empty() ? "-" : fmt::format("{}/{}", port.address, port.prefix)));
        }
    }
    words.emplace_back("---");
    std::vector<std::string> const ssh = ssh_words(on, process.ssh);
    words.insert(words.end(), ssh.begin(), ssh.end());
    // Its folder is seen from the user's home, and from there alone.
    words.push_back(fmt::format("exec {0}/bin/{1} far \"$(cd {0} && pwd)\"", bundle, kCable));
    words.emplace_back("---");
    for (std::string const& word : command) {
        words.push_back(word == config_file.string() ? "config.yaml" : word);
    }
    return words;
}

} // namespace gridspace::launcher
