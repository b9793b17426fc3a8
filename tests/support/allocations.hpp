// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace gridspace {

/// How often the program has asked for memory so far, with `new` of any kind. Linking this replaces operator new of the
/// whole program: tests that count are programs of their own.
[[nodiscard]] std::size_t allocations() noexcept;

/// The same while `work` runs.
template <class Work>
[[nodiscard]] std::size_t allocations_of(Work&& work) {
    std::size_t const before = allocations();
    work();
    return allocations() - before;
}

} // namespace gridspace
