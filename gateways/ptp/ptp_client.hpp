// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/unique_fd.hpp"
#include "gateways/ptp/management_message.hpp"

#include <filesystem>
#include <functional>

namespace gridspace::ptp {

/// Asks a PTP daemon over its local socket (linuxptp's `uds_address`) and hears its answers; never waits. The daemon
/// may come late, go, and come again.
class PtpClient {
  public:
    /// `own`: a name in the file system that answers go to. A system call that fails is an environment error.
    [[nodiscard]] static Result<PtpClient> open(std::filesystem::path const& daemon, std::filesystem::path own,
                                                std::uint8_t domain);
    ~PtpClient();
    PtpClient(PtpClient&&) noexcept = default;
    PtpClient& operator=(PtpClient&&) = delete;

    /// False: nobody is there.
    bool ask(ManagementId id);
    void hear(std::function<void(ManagementResponse const&)> const& heard);

  private:
    PtpClient(UniqueFd fd, std::filesystem::path own, std::string daemon, std::uint8_t domain)
        : fd_{std::move(fd)}, own_{std::move(own)}, daemon_{std::move(daemon)}, domain_{domain} {}

    UniqueFd fd_;
    std::filesystem::path own_; ///< empty when moved from
    std::string daemon_;
    std::uint8_t domain_;
    std::uint16_t sequence_{0};
};

} // namespace gridspace::ptp
