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
namespace {

/// The lock file at this path, opened; -1 with errno. The folder may be another user's: no link is followed, and the
/// mode is changed only of what is made here.
int open_lock(char const* file) {
    constexpr int kFlags = O_RDWR | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK;
    if (int const made = ::open(file, kFlags | O_CREAT | O_EXCL, 0600); made >= 0) {
        ::fchmod(made, 0666); // whatever the umask
        return made;
    }
    int const found = errno == EEXIST ? ::open(file, kFlags) : -1;
    struct stat what{};
    if (found >= 0 && (::fstat(found, &what) != 0 || !S_ISREG(what.st_mode))) {
        ::close(found);
        errno = EEXIST;
        return -1;
    }
    return found;
}

} // namespace

Result<DomainLock> DomainLock::take(std::filesystem::path const& folder) {
    constexpr int kFirst = 2, kLast = 98;
    if (::mkdir(folder.c_str(), 0700) == 0) {
        ::chmod(folder.c_str(), 01777); // for all users of the machine
    }
    std::optional<Error> refused;
    for (int domain = kFirst; domain <= kLast; domain += 2) {
        std::string const file = (folder / std::to_string(domain)).string();
        int const fd = open_lock(file.c_str());
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
