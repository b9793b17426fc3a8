// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace gridspace::rtps_guard {

/// Names a participant (DDSI-RTPS 2.2, 8.2.4.2).
using GuidPrefix = std::array<std::uint8_t, 12>;
/// Names a reader or writer within its participant; as a number, as documents write it: 0x000100c2.
using EntityId = std::uint32_t;

/// Reads octets in order and never beyond their end; reading too much gives zeros and ok() is false from then on.
class Octets {
  public:
    explicit Octets(std::span<std::uint8_t> octets, bool little = true) : octets_{octets}, little_{little} {}

    [[nodiscard]] bool ok() const { return ok_; }
    [[nodiscard]] std::size_t left() const { return octets_.size() - at_; }
    [[nodiscard]] std::size_t at() const { return at_; }
    void little(bool little) { little_ = little; }
    [[nodiscard]] bool little() const { return little_; }

    [[nodiscard]] std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
    [[nodiscard]] std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
    [[nodiscard]] std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
    /// High word, low word: a sequence number.
    [[nodiscard]] std::int64_t sequence_number() {
        std::uint64_t const high = u32();
        return static_cast<std::int64_t>((high << 32U) | u32());
    }
    [[nodiscard]] EntityId entity() {
        EntityId out = 0;
        for (int i = 0; i < 4; ++i) {
            out = (out << 8U) | u8();
        }
        return out;
    }
    [[nodiscard]] GuidPrefix prefix() {
        GuidPrefix out{};
        if (auto const from = take(out.size()); !from.empty()) {
            std::memcpy(out.data(), from.data(), out.size());
        }
        return out;
    }
    /// The next `size` octets; none, and not ok, when there are fewer.
    [[nodiscard]] std::span<std::uint8_t> take(std::size_t size) {
        if (size > left()) {
            ok_ = false;
            at_ = octets_.size();
            return {};
        }
        auto const out = octets_.subspan(at_, size);
        at_ += size;
        return out;
    }
    void skip(std::size_t size) { (void)take(size); }
    /// To the next multiple of four; what is missing at the end is not needed.
    void align() { at_ = at_ + 3 < octets_.size() ? (at_ + 3) & ~std::size_t{3} : octets_.size(); }

  private:
    std::uint64_t number(std::size_t size) {
        std::uint64_t out = 0;
        auto const from = take(size);
        for (std::size_t i = 0; i < from.size(); ++i) {
            out = (out << 8U) | from[little_ ? from.size() - 1 - i : i];
        }
        return out;
    }

    std::span<std::uint8_t> octets_;
    std::size_t at_{0};
    bool little_, ok_{true};
};

} // namespace gridspace::rtps_guard
