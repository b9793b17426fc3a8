// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace gridspace {

/// An IDL file of ours, as text.
struct IdlText {
    std::string_view file;
    std::string_view text;
};

[[nodiscard]] std::span<IdlText const> idl_texts();

} // namespace gridspace
