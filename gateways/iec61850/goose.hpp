// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/frame.hpp"
#include "gateways/iec61850/utc_time.hpp"

#include <string_view>

namespace gridspace::iec61850 {

/// A decoded GOOSE message, as views into the frame.
struct GooseFrame {
    enum Field : std::uint16_t {
        gocb_ref_field = 1 << 0,
        live_field = 1 << 1,
        dat_set_field = 1 << 2,
        go_id_field = 1 << 3,
        t_field = 1 << 4,
        st_num_field = 1 << 5,
        sq_num_field = 1 << 6,
        simulation_field = 1 << 7,
        conf_rev_field = 1 << 8,
        nds_com_field = 1 << 9,
        entries_field = 1 << 10,
        all_data_field = 1 << 11,
        security_field = 1 << 12,
    };

    FrameHeader header;
    std::string_view gocb_ref, dat_set, go_id; ///< go_id is empty when it was not sent
    UtcTime t;
    std::uint32_t live_ms{0}, st_num{0}, sq_num{0}, conf_rev{0};
    std::uint32_t declared_entries{0}; ///< numDatSetEntries, as it was written
    std::uint32_t entries{0};          ///< members that are there
    bool simulation{false}, nds_com{false};
    std::uint16_t fields{0}; ///< which were there
    Octets all_data{};       ///< for DataWalker
    std::uint32_t all_data_offset{0};

    [[nodiscard]] bool has(Field field) const noexcept { return (fields & field) != 0; }
    /// Either of the two places says so: Edition 1 knew only the flag of the PDU.
    [[nodiscard]] bool simulated() const noexcept { return simulation || header.simulated(); }
};

/// Reads a whole Ethernet frame of GOOSE, with or without its VLAN tag, and checks every element of allData. Tolerant:
/// defaults may be absent, integers have any length, fields stand in any order, unknown ones are skipped; what they say
/// is the subscriber's to judge. Allocates nothing; views point into `frame`.
[[nodiscard]] Decoded<void> decode_goose(Octets frame, GooseFrame& out) noexcept;

} // namespace gridspace::iec61850
