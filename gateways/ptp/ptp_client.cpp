// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/ptp/ptp_client.hpp"

#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace gridspace::ptp {
namespace {

/// Nothing when it is too long for the system.
std::optional<sockaddr_un> address_of(std::string const& path) {
    sockaddr_un out{};
    out.sun_family = AF_UNIX;
    if (path.empty() || path.size() >= sizeof out.sun_path) {
        return std::nullopt;
    }
    std::memcpy(out.sun_path, path.c_str(), path.size() + 1);
    return out;
}

} // namespace

Result<PtpClient> PtpClient::open(std::filesystem::path const& daemon, std::filesystem::path own, std::uint8_t domain) {
    auto const at = address_of(own.string());
    if (!at || !address_of(daemon.string())) {
        return fail(ExitCode::usage,
                    fmt::format("'{}' is too long for the name of a socket", (at ? daemon : own).string()),
                    fmt::format("it has at most {} octets", sizeof(sockaddr_un::sun_path) - 1));
    }
    UniqueFd fd{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
    (void)::unlink(own.c_str()); // of an incarnation before
    if (fd.get() < 0 || ::bind(fd.get(), reinterpret_cast<sockaddr const*>(&*at), sizeof *at) != 0) {
        return fail(ExitCode::environment, fmt::format("cannot open the socket '{}' for a PTP daemon: {}", own.string(),
                                                       std::strerror(errno)));
    }
    return PtpClient{std::move(fd), std::move(own), daemon.string(), domain};
}

PtpClient::~PtpClient() {
    if (fd_.get() >= 0) {
        (void)::unlink(own_.c_str());
    }
}

bool PtpClient::ask(ManagementId id) {
    auto const question = management_get(id, domain_, sequence_++);
    auto const to = address_of(daemon_);
    return ::sendto(fd_.get(), question.data(), question.size(), MSG_DONTWAIT | MSG_NOSIGNAL,
                    reinterpret_cast<sockaddr const*>(&*to), sizeof *to) == static_cast<ssize_t>(question.size());
}

void PtpClient::hear(std::function<void(ManagementResponse const&)> const& heard) {
    std::array<std::uint8_t, 1500> octets;
    constexpr int kMost = 64; // somebody who floods us does not hold us up
    for (int i = 0; i < kMost; ++i) {
        ssize_t const size = ::recv(fd_.get(), octets.data(), octets.size(), MSG_DONTWAIT);
        if (size < 0) {
            return;
        }
        if (auto const response = decode_response({octets.data(), static_cast<std::size_t>(size)}, domain_)) {
            heard(*response);
        }
    }
}

} // namespace gridspace::ptp
