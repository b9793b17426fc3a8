// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/frame.hpp"
#include "gateways/iec61850/utc_time.hpp"

#include <array>
#include <string_view>

namespace gridspace::iec61850 {

/// smpSynch of IEC 61850-9-2: 5 to 254 name a local clock, 3 and 4 are reserved.
inline constexpr std::uint8_t kNotSynchronised = 0, kLocalClock = 1, kGlobalClock = 2;

/// smpMod: what smpRate counts.
enum class SampleMode : std::uint16_t { per_period = 0, per_second = 1, seconds_per_sample = 2 };

/// More ASDUs than this do not fit in an Ethernet frame: the shortest takes 19 octets.
inline constexpr std::size_t kMaxAsdus = 80;

/// One ASDU, as views into the frame. `has` says which of the optional fields were there; the others hold zeros.
struct Asdu {
    enum Field : std::uint16_t {
        sv_id_field = 1 << 0,
        dat_set_field = 1 << 1,
        smp_cnt_field = 1 << 2,
        conf_rev_field = 1 << 3,
        refr_tm_field = 1 << 4,
        smp_synch_field = 1 << 5,
        smp_rate_field = 1 << 6,
        sample_field = 1 << 7,
        smp_mod_field = 1 << 8,
        gm_identity_field = 1 << 9,
    };

    std::string_view sv_id, dat_set;
    Octets sample; ///< the data set: no tags, no lengths (sv_data_set.hpp)
    UtcTime refr_tm;
    std::uint64_t gm_identity{0};
    std::uint32_t conf_rev{0};
    std::uint16_t smp_cnt{0}, smp_rate{0}, smp_mod{0};
    std::uint16_t fields{0};
    std::uint8_t smp_synch{0};
    std::uint32_t offset{0}; ///< of the ASDU in the frame, for messages

    [[nodiscard]] bool has(Field field) const noexcept { return (fields & field) != 0; }
};

/// A decoded frame of sampled values. Make one and reuse it: it is the decoder's memory.
struct SvFrame {
    FrameHeader header;
    std::uint16_t count{0};
    bool secured{false}; ///< the element [1] "security" was there; it was not verified
    std::array<Asdu, kMaxAsdus> asdus;

    [[nodiscard]] std::span<Asdu const> view() const noexcept { return {asdus.data(), count}; }
};

/// Reads a whole Ethernet frame of SV, with or without its VLAN tag. Tolerant: fixed-width fields may have any length
/// that holds their value, fields may stand in any order, unknown ones are skipped. Allocates nothing; views point into
/// `frame`.
[[nodiscard]] Decoded<void> decode_sv(Octets frame, SvFrame& out) noexcept;

/// The same, each element looked at one by one also where all is as usual: what the tests hold decode_sv() against.
[[nodiscard]] Decoded<void> decode_sv_without_shortcut(Octets frame, SvFrame& out) noexcept;

} // namespace gridspace::iec61850
