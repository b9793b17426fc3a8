// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "gateways/iec61850/sv.hpp"

#include <cassert>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::iec61850 {

class BerWriter;

/// The constant part of one ASDU.
struct AsduDescription {
    std::string sv_id;
    std::string dat_set; ///< empty: not sent
    std::uint32_t conf_rev{1};
    std::uint8_t smp_synch{kGlobalClock};
    bool refr_tm{false}; ///< sent, from set_refr_tm()
    std::optional<std::uint16_t> smp_rate;
    std::optional<SampleMode> smp_mod;
    std::optional<std::uint64_t> gm_identity;
    std::size_t sample_octets{0};
};

/// A frame of sampled values with everything constant written once; what changes is patched in place. One to sixteen
/// ASDUs, of one stream (consecutive samples) or of several (several svIDs).
class SvTemplate {
  public:
    static constexpr std::size_t kMaxAsdusSent = 16, kMaxSvId = 129;

    [[nodiscard]] static Result<SvTemplate> create(Address const& address, std::vector<AsduDescription> const& asdus);

    [[nodiscard]] std::size_t asdus() const noexcept { return slots_.size(); }
    [[nodiscard]] Octets frame() const noexcept { return frame_; }

    void set_smp_cnt(std::size_t asdu, std::uint16_t smp_cnt) noexcept { patch(slots_[asdu].smp_cnt, smp_cnt); }
    void set_smp_synch(std::size_t asdu, std::uint8_t synch) noexcept { frame_[slots_[asdu].smp_synch] = synch; }
    void set_conf_rev(std::size_t asdu, std::uint32_t conf_rev) noexcept { patch(slots_[asdu].conf_rev, conf_rev); }
    /// Nothing happens in a frame that does not carry it.
    void set_refr_tm(std::size_t asdu, UtcTime time) noexcept {
        if (slots_[asdu].refr_tm != 0) { // the destination address is there
            patch(slots_[asdu].refr_tm, time.bits());
        }
    }
    /// The data set of an ASDU, to be written in place (SvLayout::write, store_float).
    [[nodiscard]] std::span<std::uint8_t> sample(std::size_t asdu) noexcept {
        return {frame_.data() + slots_[asdu].sample, slots_[asdu].sample_octets};
    }
    void set_source(Mac const& source) noexcept;
    void set_simulated(bool simulated) noexcept;

  private:
    struct Slot {
        std::uint32_t smp_cnt{0}, conf_rev{0}, smp_synch{0}, refr_tm{0}, sample{0}, sample_octets{0};
    };
    /// Writes an ASDU with nothing in the fields that change; gives where these are. `w` begins at `start` of the
    /// frame.
    static Slot append_asdu(AsduDescription const& asdu, std::size_t start, BerWriter& w);

    template <class T>
    void patch(std::size_t at, T value) noexcept {
        store_be(frame_.data() + at, value);
    }

    std::vector<std::uint8_t> frame_;
    std::vector<Slot> slots_;
    std::size_t reserved1_{0};
};

/// A FLOAT32 of a sample, as three of them make the plain set of phase currents.
inline void store_float(std::span<std::uint8_t> sample, std::size_t offset, float value) noexcept {
    assert(offset + 4 <= sample.size());
    store_be(sample.data() + offset, std::bit_cast<std::uint32_t>(value));
}
[[nodiscard]] inline float load_float(Octets sample, std::size_t offset) noexcept {
    assert(offset + 4 <= sample.size());
    return std::bit_cast<float>(load_be<std::uint32_t>(sample.data() + offset));
}

} // namespace gridspace::iec61850
