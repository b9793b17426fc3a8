// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

/// Management messages of the Precision Time Protocol (IEEE 1588-2008, clause 15): what a daemon says about the clock
/// that it follows. Pure.
namespace gridspace::ptp {

/// An EUI-64.
using ClockIdentity = std::array<std::uint8_t, 8>;

/// What can be asked for (table 40; 0xC000 is linuxptp's own).
enum class ManagementId : std::uint16_t { parent_data_set = 0x2002, time_status = 0xC000 };

/// TIME_STATUS_NP of linuxptp.
struct TimeStatus {
    std::int64_t master_offset_ns{0}; ///< of the last measurement
    std::int64_t ingress_ns{0};       ///< when that was, on the daemon's clock
    bool grandmaster_present{false};  ///< false: it follows nobody, or is the grandmaster itself
    ClockIdentity grandmaster{};
};

/// PARENT_DATA_SET, 15.5.3.5.1.
struct ParentDataSet {
    ClockIdentity grandmaster{};
    std::uint8_t clock_class{255}; ///< of the grandmaster: table 5, and IEC/IEEE 61850-9-3
};

/// The answer to one question.
struct ManagementResponse {
    ClockIdentity from{};
    std::uint16_t sequence{0};
    std::optional<TimeStatus> time_status;
    std::optional<ParentDataSet> parent;
};

/// The question for a data set, for every clock that hears it.
[[nodiscard]] std::vector<std::uint8_t> management_get(ManagementId id, std::uint8_t domain, std::uint16_t sequence);

/// Nothing for what is no answer to one of the questions above in this domain, or cut short.
[[nodiscard]] std::optional<ManagementResponse> decode_response(std::span<std::uint8_t const> message,
                                                                std::uint8_t domain);

} // namespace gridspace::ptp
