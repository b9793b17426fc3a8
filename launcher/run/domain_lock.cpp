// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/domain_lock.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <optional>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace gridspace::launcher {

Result<DomainLock> DomainLock::take(std::filesystem::path const& folder) {
    constexpr int kFirst = 2, kLast = 98;
    ::mkdir(folder.c_str(), 0777);
    ::chmod(folder.c_str(), 01777); // it may be another user's
    std::optional<Error> refused;
    for (int domain = kFirst; domain <= kLast; domain += 2) {
        std::string const file = (folder / std::to_string(domain)).string();
        int const fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (fd < 0) {
            if (!refused) {
                refused =
                    Error{ExitCode::environment,
                          fmt::format("cannot reserve DDS domains: '{}': {}", file, std::strerror(errno)),
                          "runs on the loopback interface keep apart by locks on files of that folder: it must be "
                          "writable"};
            }
            continue;
        }
        ::fchmod(fd, 0666);
        if (::flock(fd, LOCK_EX | LOCK_NB) == 0) {
            return DomainLock{fd, domain};
        }
        ::close(fd);
    }
    return refused ? std::unexpected{*refused}
                   : fail(ExitCode::environment, "no pair of DDS domains is free on this machine",
                          fmt::format("{} runs at once? each of them holds a lock on a file in '{}'",
                                      (kLast - kFirst) / 2 + 1, folder.string()));
}

DomainLock::DomainLock(DomainLock&& other) noexcept : fd_{std::exchange(other.fd_, -1)}, first_{other.first_} {}

DomainLock& DomainLock::operator=(DomainLock&& other) noexcept {
    std::swap(fd_, other.fd_);
    std::swap(first_, other.first_);
    return *this;
}

DomainLock::~DomainLock() {
    if (fd_ >= 0) {
        ::close(fd_);
    }
}

} // namespace gridspace::launcher
