// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace gridspace::bus {

/// That fit into one sample of `signals` (MAX_SIGNALS of idl/signals.idl).
inline constexpr std::size_t kMaxSignals = 1024;

/// Of the IDL texts that others publish, who keeps them for decoding keeps these: text by text, and all together.
inline constexpr std::size_t kLongestIdl = 256U << 10U, kMostIdl = 16U << 20U;

/// Topics that always travel on the management network: the framework's own.
[[nodiscard]] bool is_management_topic(std::string_view topic);

/// Topics whose content may differ between two runs of one scenario; not in ledgers, not compared.
[[nodiscard]] bool is_diagnostic_topic(std::string_view topic);

/// The IDL text that defines a type of ours; empty for an unknown type.
[[nodiscard]] std::string_view idl_of_type(std::string_view type_name);

} // namespace gridspace::bus
