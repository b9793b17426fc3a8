// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/idl/native_layout.hpp"

#include <cstddef>
#include <memory_resource>
#include <span>
#include <vector>

namespace gridspace::idl {

/// Decodes a sample (plain CDR, XCDR1, with its encapsulation header) into a struct of C: `layout.size()` octets at
/// `out`, aligned for anything. What the struct points to is of `memory`. Never reads outside of `cdr`; false when it
/// is not of the type.
[[nodiscard]] bool decode(NativeLayout const& layout, std::span<std::byte const> cdr, void* out,
                          std::pmr::memory_resource& memory);

/// Encodes a struct of C as little-endian CDR with its header; `out` is replaced. Fails with the name of the member
/// that cannot be sent: a text or sequence beyond its bound, a number that is not finite, an unknown value of an enum.
/// A null string counts as an empty one.
[[nodiscard]] Result<void> encode(NativeLayout const& layout, void const* sample, std::vector<std::byte>& out);

} // namespace gridspace::idl
