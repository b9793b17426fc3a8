// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/monitor_client.hpp"

#include "common/unique_fd.hpp"
#include "launcher/run/tls_client.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/random.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

constexpr char const* kNote = "monitor.address";

Result<UniqueFd> connect_to(std::string const& where) {
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
    timeval const patience{5, 0};
    ::setsockopt(fd.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    ::setsockopt(fd.get(), SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    if (::connect(fd.get(), reinterpret_cast<sockaddr const*>(&address), sizeof address) != 0) {
        return fail(ExitCode::environment, fmt::format("no monitor answers at {}: {}", where, std::strerror(errno)),
                    "the run is over, or runs without a monitor");
    }
    return fd;
}

} // namespace

void note_monitor(std::filesystem::path const& folder, MonitorAddress const& monitor) {
    std::ofstream{folder / kNote} << monitor.url() << '\n'
                                  << monitor.certificate.string() << '\n'
                                  << monitor.token_file.string() << '\n';
}

Result<MonitorAddress> monitor_address(std::filesystem::path const& run) {
    constexpr std::string_view kPlain = "http://";
    std::string text = run.string();
    if (std::filesystem::is_directory(run)) {
        std::ifstream stream{run / kNote};
        std::string url, certificate, token_file;
        if (!std::getline(stream, url)) {
            return fail(ExitCode::usage, fmt::format("run '{}' has no monitor", text), "was it started with one?");
        }
        std::getline(stream, certificate);
        std::getline(stream, token_file);
        return MonitorAddress{url.substr(url.find("//") + 2), certificate, token_file};
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

Result<std::string> exchange(int socket, std::string const& request) {
    std::string answer;
    char buffer[65536];
    ssize_t size = ::send(socket, request.data(), request.size(), MSG_NOSIGNAL);
    while (size > 0 && (size = ::recv(socket, buffer, sizeof buffer, 0)) > 0) {
        answer.append(buffer, static_cast<std::size_t>(size));
    }
    return answer;
}

/// Sends a request and returns the body of its answer. `token` empty: the monitor's own, if it asks for one.
Result<std::string> talk(MonitorAddress const& monitor, std::string_view method, std::string_view path,
                         std::string token, std::string_view content) {
    auto const fd = connect_to(monitor.address);
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
    auto const answer = monitor.certificate.empty() ? exchange(fd->get(), request)
                                                    : exchange_by_tls(fd->get(), monitor.certificate, request);
    if (!answer) {
        return answer;
    }
    std::size_t const head = answer->find("\r\n\r\n");
    if (!answer->starts_with("HTTP/1.1 ") || head == std::string::npos) {
        return fail(ExitCode::environment, fmt::format("what answers at {} is not a monitor", monitor.url()));
    }
    std::string body = answer->substr(head + 4);
    int const status = std::atoi(answer->c_str() + 9);
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

Result<std::string> ask_monitor(MonitorAddress const& monitor, std::string const& path) {
    return talk(monitor, "GET", path, {}, {});
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
    auto const answer = talk(*monitor, "POST", "/api/v1/control", token, fmt::format(R"({{"action":"{}"}})", action));
    return answer ? Result<void>{} : std::unexpected{answer.error()};
}

} // namespace gridspace::launcher
