// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/domain_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace gridspace::launcher {

std::optional<DomainLock> DomainLock::take() {
    constexpr int kFirst = 2, kLast = 98;
    ::mkdir("/tmp/gridspace-domains", 0777);
    ::chmod("/tmp/gridspace-domains", 01777);
    for (int domain = kFirst; domain <= kLast; domain += 2) {
        std::string const file = fmt::format("/tmp/gridspace-domains/{}", domain);
        int const fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (fd < 0) {
            continue;
        }
        ::fchmod(fd, 0666);
        if (::flock(fd, LOCK_EX | LOCK_NB) == 0) {
            return DomainLock{fd, domain};
        }
        ::close(fd);
    }
    return std::nullopt;
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
