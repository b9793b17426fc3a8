// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>

namespace gridspace::launcher {

/// Two DDS domains that no other run on this machine uses, for runs without namespaces. Held by a file lock, so that a
/// killed run gives them back. Domains above 101 would use ports that the kernel hands out to others.
class DomainLock {
  public:
    /// An error says which file cannot be had, or that all pairs are taken.
    [[nodiscard]] static Result<DomainLock> take(std::filesystem::path const& folder = "/tmp/gridspace-domains");
    DomainLock(DomainLock&& other) noexcept;
    DomainLock& operator=(DomainLock&& other) noexcept;
    DomainLock(DomainLock const&) = delete;
    DomainLock& operator=(DomainLock const&) = delete;
    ~DomainLock();
    [[nodiscard]] int first() const { return first_; }

  private:
    DomainLock(int fd, int first) : fd_{fd}, first_{first} {}
    int fd_;
    int first_;
};

} // namespace gridspace::launcher
