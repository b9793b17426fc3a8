// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/monitor_client.hpp"

#include "common/unique_fd.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <netinet/in.h>
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
    if (::inet_pton(AF_INET, host == "localhost" ? "127.0.0.1" : host.c_str(), &address.sin_addr) != 1) {
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

void note_monitor(std::filesystem::path const& folder, std::string const& address) {
    std::ofstream{folder / kNote} << address << '\n';
}

Result<std::string> monitor_address(std::filesystem::path const& run) {
    std::string text = run.string();
    if (text.starts_with("http://")) {
        text = text.substr(7);
        return text.substr(0, text.find('/'));
    }
    if (std::filesystem::is_directory(run)) {
        std::string address;
        if (std::getline(std::ifstream{run / kNote} >> std::ws, address)) {
            return address;
        }
        return fail(ExitCode::usage, fmt::format("run '{}' has no monitor", text), "was it started with one?");
    }
    if (text.find(':') != std::string::npos) {
        return text;
    }
    return fail(ExitCode::usage, fmt::format("'{}' is neither a run folder nor the address of a monitor", text),
                "`gridspace run` prints both");
}

namespace {

/// Sends a request and returns the body of its answer.
Result<std::string> talk(std::string const& address, std::string const& request) {
    auto fd = connect_to(address);
    if (!fd) {
        return std::unexpected{fd.error()};
    }
    std::string answer;
    char buffer[65536];
    ssize_t size = ::send(fd->get(), request.data(), request.size(), MSG_NOSIGNAL);
    while (size > 0 && (size = ::recv(fd->get(), buffer, sizeof buffer, 0)) > 0) {
        answer.append(buffer, static_cast<std::size_t>(size));
    }
    std::size_t const head = answer.find("\r\n\r\n");
    if (!answer.starts_with("HTTP/1.1 ") || head == std::string::npos) {
        return fail(ExitCode::environment, fmt::format("what answers at {} is not a monitor", address));
    }
    std::string body = answer.substr(head + 4);
    int const status = std::atoi(answer.c_str() + 9);
    if (status / 100 != 2) {
        return fail(ExitCode::usage, fmt::format("the monitor says {}: {}", status, body));
    }
    return body;
}

constexpr char const* kToken = "control.token";

} // namespace

Result<std::string> ask_monitor(std::string const& address, std::string const& path) {
    return talk(address, fmt::format("GET {} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n", path));
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
        return fail(ExitCode::environment, fmt::format("cannot write '{}': {}", (folder / kToken).string(), std::strerror(errno)));
    }
    return {};
}

Result<void> control_run(std::filesystem::path const& folder, std::string const& action) {
    auto const address = monitor_address(folder);
    if (!address) {
        return std::unexpected{address.error()};
    }
    std::ifstream stream{folder / kToken};
    std::string token;
    if (!std::getline(stream, token)) {
        return fail(ExitCode::usage, fmt::format("run '{}' may not be controlled", folder.string()),
                    "start it with `gridspace run --allow-control`");
    }
    std::string const body = fmt::format(R"({{"action":"{}"}})", action);
    auto const answer = talk(*address, fmt::format("POST /api/v1/control HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n"
                                                   "Authorization: Bearer {}\r\nContent-Type: application/json\r\n"
                                                   "Content-Length: {}\r\n\r\n{}",
                                                   token, body.size(), body));
    return answer ? Result<void>{} : std::unexpected{answer.error()};
}

} // namespace gridspace::launcher
