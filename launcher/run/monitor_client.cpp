// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/monitor_client.hpp"

#include "common/text.hpp"
#include "common/unique_fd.hpp"
#include "launcher/run/tls_client.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

constexpr char const* kNote = "monitor.address";

Result<UniqueFd> connect_to(std::string const& where, std::chrono::milliseconds patience) {
    std::size_t const colon = where.rfind(':');
    sockaddr_in address{};
    address.sin_family = AF_INET;
    std::string const host = colon == std::string::npos ? where : where.substr(0, colon);
    address.sin_port = htons(static_cast<std::uint16_t>(
        colon == std::string::npos ? 80 : std::strtoul(where.c_str() + colon + 1, nullptr, 10)));
    std::string const at = host == "localhost" || host == "0.0.0.0" ? "127.0.0.1" : host;
    if (::inet_pton(AF_INET, at.c_str(), &address.sin_addr) != 1) {
        return fail(ExitCode::usage, fmt::format("'{}' is not an address", where), "for example 127.0.0.1:8080");
    }
    UniqueFd fd{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
    timeval const limit{patience.count() / 1000, patience.count() % 1000 * 1000};
    ::setsockopt(fd.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    ::setsockopt(fd.get(), SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    if (::connect(fd.get(), reinterpret_cast<sockaddr const*>(&address), sizeof address) != 0) {
        return fail(ExitCode::environment, fmt::format("no monitor answers at {}: {}", where, std::strerror(errno)),
                    "the run is over, or runs without a monitor");
    }
    return fd;
}

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
                "`gridspace run` prints both");
}

namespace {

constexpr char const* kToken = "control.token";

std::string first_line(std::filesystem::path const& file) {
    std::ifstream stream{file};
    std::string line;
    std::getline(stream, line);
    return line;
}

/// What has come when the other side ends it, or `silent` when it says nothing any more.
Answer exchange(int socket, std::string const& request) {
    Answer answer;
    char buffer[65536];
    ssize_t size = ::send(socket, request.data(), request.size(), MSG_NOSIGNAL);
    while (size > 0 && (size = ::recv(socket, buffer, sizeof buffer, 0)) > 0) {
        answer.text.append(buffer, static_cast<std::size_t>(size));
    }
    answer.silent = size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
    return answer;
}

/// The length that the head of an answer promises for its body.
std::optional<std::size_t> content_length(std::string head) {
    std::transform(head.begin(), head.end(), head.begin(), [](unsigned char c) { return std::tolower(c); });
    constexpr std::string_view kKey = "\r\ncontent-length:";
    std::size_t const at = head.find(kKey);
    return at == std::string::npos
               ? std::nullopt
               : std::optional<std::size_t>{std::strtoull(head.c_str() + at + kKey.size(), nullptr, 10)};
}

/// Sends a request and returns the body of its answer. `token` empty: the monitor's own, if it asks for one.
Result<std::string> talk(MonitorAddress const& monitor, std::string_view method, std::string_view path,
                         std::string token, std::string_view content, std::chrono::milliseconds patience) {
    auto const fd = connect_to(monitor.address, patience);
    if (!fd) {
        return std::unexpected{fd.error()};
    }
    if (token.empty() && !monitor.token_file.empty()) {
        token = first_line(monitor.token_file);
    }
    std::string request = fmt::format("{} {} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n", method, path);
    if (!token.empty()) {
        request += fmt::format("Authorization: Bearer {}\r\n", token);
    }
    if (!content.empty()) {
        request += fmt::format("Content-Type: application/json\r\nContent-Length: {}\r\n", content.size());
    }
    request += "\r\n";
    request += content;
    auto const answer = monitor.certificate.empty() ? Result<Answer>{exchange(fd->get(), request)}
                                                    : exchange_by_tls(fd->get(), monitor.certificate, request);
    if (!answer) {
        return std::unexpected{answer.error()};
    }
    std::string const& text = answer->text;
    std::size_t const head = text.find("\r\n\r\n");
    constexpr std::string_view kBegin = "HTTP/1.1 ";
    if (!text.starts_with(kBegin) && !kBegin.starts_with(text)) {
        return fail(ExitCode::environment, fmt::format("what answers at {} is not a monitor", monitor.url()));
    }
    std::string body = head == std::string::npos ? "" : text.substr(head + 4);
    auto const length = head == std::string::npos ? std::nullopt : content_length(text.substr(0, head));
    bool const is_whole = head != std::string::npos && (length ? body.size() >= *length : !answer->silent);
    if (!is_whole && answer->silent) {
        return fail(ExitCode::environment,
                    fmt::format("the monitor at {} has not answered within {} s{}", monitor.url(),
                                shortest(std::chrono::duration<double>(patience).count()),
                                text.empty() ? "" : fmt::format(": {} octets of its answer came", text.size())),
                    "its machine is very busy, or it is stopped: try again");
    }
    if (!is_whole) {
        return fail(
            ExitCode::environment,
            text.empty()
                ? fmt::format("the monitor at {} has ended the connection without an answer", monitor.url())
                : fmt::format("the answer of the monitor at {} was cut after {} octets", monitor.url(), text.size()),
            "the run may just have ended: try again");
    }
    long const status = std::strtol(text.c_str() + kBegin.size(), nullptr, 10);
    if (status / 100 != 2) {
        auto const said = nlohmann::json::parse(body, nullptr, false);
        return said.is_object() && said.contains("error")
                   ? fail(ExitCode::usage,
                          said["error"].is_string() ? said["error"].get<std::string>() : said["error"].dump(),
                          said.value("remedy", ""))
                   : fail(ExitCode::usage, fmt::format("the monitor says {}: {}", status, body));
    }
    return body;
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
