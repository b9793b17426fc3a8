// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/monitor_client.hpp"

#include "common/json_value.hpp"
#include "common/text.hpp"
#include "common/unique_fd.hpp"
#include "launcher/run/monitor_http.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

constexpr char const* kNote = "monitor.address";

} // namespace

Result<UniqueFd> note_monitor(std::filesystem::path const& folder, MonitorAddress const& monitor) {
    std::filesystem::path const file = folder / kNote;
    std::string const text =
        fmt::format("{}\n{}\n{}\n", monitor.url(), monitor.certificate.string(), monitor.token_file.string());
    ::unlink(file.c_str()); // of another monitor of the run: the last one counts
    UniqueFd fd{::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600)};
    if (!fd || ::flock(fd.get(), LOCK_EX | LOCK_NB) != 0 ||
        ::write(fd.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
        return fail(ExitCode::environment, fmt::format("cannot write '{}': {}", file.string(), std::strerror(errno)));
    }
    return fd;
}

namespace {

/// What the note of a run says, when it can be believed.
Result<MonitorAddress> noted_monitor(std::filesystem::path const& run) {
    UniqueFd const fd{::open((run / kNote).c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)};
    struct stat found{};
    if (!fd || ::fstat(fd.get(), &found) != 0) {
        return errno == EACCES ? fail(ExitCode::usage, fmt::format("run '{}' is another user's", run.string()),
                                      "give the address of its monitor: `gridspace run` printed it")
                               : fail(ExitCode::usage, fmt::format("run '{}' has no monitor", run.string()),
                                      "was it started with one?");
    }
    if (!S_ISREG(found.st_mode) || found.st_uid != ::geteuid() || (found.st_mode & 077U) != 0) {
        return fail(ExitCode::usage, fmt::format("'{}' is not what a run of yours wrote", (run / kNote).string()),
                    "if you trust it, give the address that it holds: for example --run 127.0.0.1:8080");
    }
    if (::flock(fd.get(), LOCK_SH | LOCK_NB) == 0) {
        return fail(ExitCode::usage, fmt::format("run '{}' is over", run.string()),
                    "`gridspace monitor` shows it in the dashboard again");
    }
    char text[4096];
    ssize_t const size = ::read(fd.get(), text, sizeof text);
    auto const lines = split({text, static_cast<std::size_t>(std::max<ssize_t>(size, 0))}, '\n');
    std::size_t const host = lines[0].find("//");
    if (lines.size() != 4 || host == std::string::npos) {
        return fail(ExitCode::usage, fmt::format("'{}' is damaged", (run / kNote).string()));
    }
    return MonitorAddress{lines[0].substr(host + 2), lines[1], lines[2]};
}

} // namespace

Result<MonitorAddress> monitor_address(std::filesystem::path const& run) {
    constexpr std::string_view kPlain = "http://";
    std::string text = run.string();
    std::error_code ignored;
    if (std::filesystem::is_directory(run, ignored)) {
        return noted_monitor(run);
    }
    if (text.starts_with("https:/")) {
        return fail(
            ExitCode::usage, fmt::format("what certificate does {} show?", text),
            "give the folder of the run, which knows; or ask by curl with --cacert and an Authorization header");
    }
    if (text.starts_with(kPlain)) {
        text = text.substr(kPlain.size());
        return MonitorAddress{text.substr(0, text.find('/')), {}, {}};
    }
    if (text.find(':') != std::string::npos) {
        return MonitorAddress{text, {}, {}};
    }
    return fail(ExitCode::usage, fmt::format("'{}' is neither a run folder nor the address of a monitor", text),
                "is a scenario running? `gridspace run` prints its folder and the address of its monitor");
}

namespace {

constexpr char const* kToken = "control.token";

std::string first_line(std::filesystem::path const& file) {
    std::ifstream stream{file};
    std::string line;
    std::getline(stream, line);
    return line;
}

/// Sends a request and returns the body of its answer. `token` empty: the monitor's own, if it asks for one.
Result<std::string> talk(MonitorAddress const& monitor, std::string_view method, std::string_view path,
                         std::string token, std::string_view content, std::chrono::milliseconds patience) {
    if (token.empty() && !monitor.token_file.empty()) {
        token = first_line(monitor.token_file);
    }
    auto reply = exchange(monitor, method, path, token, std::string{content}, patience);
    if (!reply) {
        return std::unexpected{reply.error()};
    }
    if (reply->status / 100 != 2) {
        auto const said = nlohmann::json::parse(reply->body, nullptr, false);
        return said.is_object() && said.contains("error")
                   ? fail(ExitCode::usage,
                          said["error"].is_string() ? said["error"].get<std::string>() : said["error"].dump(),
                          text_of(said, "remedy"))
                   : fail(ExitCode::usage, fmt::format("the monitor says {}: {}", reply->status, reply->body));
    }
    return std::move(reply->body);
}

} // namespace

Result<std::string> ask_monitor(MonitorAddress const& monitor, std::string const& path,
                                std::chrono::milliseconds patience) {
    return talk(monitor, "GET", path, {}, {}, patience);
}

Result<void> write_control_token(std::filesystem::path const& folder) {
    std::uint8_t secret[16];
    std::string text;
    if (::getrandom(secret, sizeof secret, 0) != sizeof secret) {
        return fail(ExitCode::environment, "the kernel gives no random numbers for the control token");
    }
    for (std::uint8_t const octet : secret) {
        text += fmt::format("{:02x}", octet);
    }
    text += '\n';
    UniqueFd const fd{::open((folder / kToken).c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600)};
    if (fd.get() < 0 || ::write(fd.get(), text.data(), text.size()) != static_cast<ssize_t>(text.size())) {
        return fail(ExitCode::environment,
                    fmt::format("cannot write '{}': {}", (folder / kToken).string(), std::strerror(errno)));
    }
    return {};
}

Result<void> control_run(std::filesystem::path const& folder, std::string const& action) {
    auto const monitor = monitor_address(folder);
    if (!monitor) {
        return std::unexpected{monitor.error()};
    }
    std::string const token = first_line(folder / kToken);
    if (token.empty()) {
        return fail(ExitCode::usage, fmt::format("run '{}' may not be controlled", folder.string()),
                    "start it with `gridspace run --allow-control`");
    }
    auto const answer =
        talk(*monitor, "POST", "/api/v1/control", token, fmt::format(R"({{"action":"{}"}})", action), kMonitorPatience);
    return answer ? Result<void>{} : std::unexpected{answer.error()};
}

} // namespace gridspace::launcher
