// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/data_set.hpp"

#include <cassert>
#include <optional>

namespace gridspace::iec61850 {

/// Octets of a type in the `sample` of an ASDU (IEC 61850-9-2, table 14): big-endian, without tag or length.
[[nodiscard]] std::size_t sv_octets(BasicType type) noexcept;

/// Reads / writes one basic value of a sample; `at` must be sv_octets() long. Strings are padded with zeros when
/// written and read up to the first zero (visible) or whole (octets).
[[nodiscard]] Value read_sv_value(BasicType type, Octets at) noexcept;
void write_sv_value(Value const& value, std::span<std::uint8_t> at) noexcept;

/// Where the values of a data set stand in a sample.
class SvLayout {
  public:
    struct Slot {
        Leaf leaf;
        std::size_t offset{0}, octets{0};
    };

    explicit SvLayout(DataSet const& data_set);

    [[nodiscard]] std::size_t sample_octets() const noexcept { return octets_; }
    [[nodiscard]] std::vector<Slot> const& slots() const noexcept { return slots_; }
    [[nodiscard]] std::optional<std::size_t> index_of(std::string_view name) const noexcept;

    /// `sample` must have sample_octets(): check it once per frame.
    [[nodiscard]] Value read(std::size_t slot, Octets sample) const noexcept {
        Slot const& s = slots_[slot];
        assert(s.offset + s.octets <= sample.size());
        if (s.octets == 4 && s.leaf.type != BasicType::bit_string) { // nearly all: currents, voltages, qualities
            auto const bits = load_be<std::uint32_t>(sample.data() + s.offset);
            return {s.leaf.type,
                    0,
                    is_signed(s.leaf.type) ? static_cast<std::uint64_t>(std::int64_t{static_cast<std::int32_t>(bits)})
                                           : bits,
                    {}};
        }
        return read_sv_value(s.leaf.type, sample.subspan(s.offset, s.octets));
    }
    void write(std::size_t slot, Value const& value, std::span<std::uint8_t> sample) const noexcept {
        Slot const& s = slots_[slot];
        assert(s.offset + s.octets <= sample.size());
        if (s.octets == 4) {
            store_be(sample.data() + s.offset, static_cast<std::uint32_t>(value.bits));
            return;
        }
        write_sv_value(value, sample.subspan(s.offset, s.octets));
    }
    /// A value per slot.
    void write_all(std::span<Value const> values, std::span<std::uint8_t> sample) const noexcept {
        assert(values.size() == slots_.size() && sample.size() >= octets_);
        if (all_of_four_octets_) { // 9-2LE, phase currents: words one behind the other
            std::uint8_t* to = sample.data();
            for (Value const& value : values) {
                store_be(to, static_cast<std::uint32_t>(value.bits));
                to += 4;
            }
            return;
        }
        for (std::size_t i = 0; i < slots_.size(); ++i) {
            write(i, values[i], sample);
        }
    }

  private:
    std::vector<Slot> slots_;
    std::size_t octets_{0};
    bool all_of_four_octets_{true};
};

} // namespace gridspace::iec61850
