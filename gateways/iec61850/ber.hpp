// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/decode_error.hpp"
#include "gateways/iec61850/octets.hpp"

namespace gridspace::iec61850 {

/// One element of BER (ISO 8825-1): tag, length, value. Tags of several octets are packed into `tag`, first octet
/// highest.
struct Tlv {
    std::uint32_t tag{0};
    std::uint32_t offset{0};       ///< of the tag, from the start of the frame
    std::uint32_t value_offset{0}; ///< of the value
    Octets value{};

    [[nodiscard]] DecodeError error(Reason reason) const noexcept {
        return {offset, reason, static_cast<std::uint8_t>(tag)};
    }
};

/// Walks over the elements of a content, never outside of it. Every call of next() advances or fails.
class BerCursor {
  public:
    BerCursor(Octets content, std::uint32_t offset) noexcept
        : begin_{content.data()}, at_{begin_}, end_{begin_ + content.size()}, offset_{offset} {}
    explicit BerCursor(Tlv const& container) noexcept : BerCursor{container.value, container.value_offset} {}

    [[nodiscard]] bool at_end() const noexcept { return at_ == end_; }
    [[nodiscard]] std::uint32_t offset() const noexcept { return offset_ + static_cast<std::uint32_t>(at_ - begin_); }

    /// Reads the next element. Any length form is accepted but the indefinite, the reserved and those above four
    /// octets.
    [[nodiscard]] Reason next(Tlv& out) noexcept {
        out.offset = offset();
        if (end_ - at_ < 2) {
            out.tag = at_ == end_ ? 0 : *at_;
            return Reason::truncated;
        }
        std::uint32_t const tag = *at_++;
        out.tag = tag;
        if ((tag & 0x1FU) == 0x1FU) {
            if (Reason const reason = long_tag(out); reason != Reason::none) {
                return reason;
            }
        }
        std::size_t length = *at_++;
        if (length >= 0x80) {
            if (Reason const reason = long_length(length); reason != Reason::none) {
                return reason;
            }
        }
        if (length > static_cast<std::size_t>(end_ - at_)) {
            return Reason::truncated;
        }
        out.value_offset = offset();
        out.value = Octets{at_, length};
        at_ += length;
        return Reason::none;
    }

  private:
    Reason long_tag(Tlv& out) noexcept {
        for (int octets = 0;; ++octets) {
            if (octets == 3) {
                return Reason::bad_tag;
            }
            if (end_ - at_ < 2) {
                return Reason::truncated;
            }
            std::uint8_t const octet = *at_++;
            out.tag = out.tag << 8 | octet;
            if ((octet & 0x80U) == 0) {
                return Reason::none;
            }
        }
    }
    Reason long_length(std::size_t& length) noexcept {
        std::size_t const octets = length & 0x7FU;
        if (octets == 0 || octets > 4) {
            return Reason::bad_length_form;
        }
        if (static_cast<std::size_t>(end_ - at_) < octets) {
            return Reason::truncated;
        }
        length = load_be(Octets{at_, octets});
        at_ += octets;
        return Reason::none;
    }

    std::uint8_t const* begin_;
    std::uint8_t const* at_;
    std::uint8_t const* end_;
    std::uint32_t offset_;
};

/// Reads an unsigned value of any length in 1 to 9 octets that fits `T`: minimal, with a leading zero, or of fixed
/// width (peers use all three). Negative BER integers cannot be told from fixed-width ones and are read as the latter.
template <class T>
[[nodiscard]] inline Reason read_unsigned(Octets value, T& out) noexcept {
    if (value.size() == sizeof(T)) [[likely]] {
        out = load_be<T>(value.data());
        return Reason::none;
    }
    if (value.size() == 1) { // numbers of messages are short, in their shortest form
        out = value[0];
        return Reason::none;
    }
    if (value.empty() || value.size() > 9) {
        return Reason::bad_value;
    }
    while (value.size() > sizeof(T)) {
        if (value.front() != 0) {
            return Reason::bad_value;
        }
        value = value.subspan(1);
    }
    out = static_cast<T>(load_be(value));
    return Reason::none;
}

/// Octets that a length takes.
[[nodiscard]] constexpr std::size_t length_octets(std::size_t length) noexcept {
    return length < 0x80 ? 1 : length < 0x100 ? 2 : length < 0x10000 ? 3 : 4;
}

/// Octets of an element with a tag of one octet and so many octets of content.
[[nodiscard]] constexpr std::size_t element_octets(std::size_t content) noexcept {
    return 1 + length_octets(content) + content;
}

/// Octets of an unsigned / signed integer in its shortest form.
[[nodiscard]] constexpr std::size_t minimal_unsigned_octets(std::uint64_t value) noexcept {
    return static_cast<std::size_t>(std::bit_width(value)) / 8 + 1;
}
[[nodiscard]] constexpr std::size_t minimal_signed_octets(std::int64_t value) noexcept {
    std::uint64_t const magnitude = value < 0 ? ~static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value);
    return static_cast<std::size_t>(std::bit_width(magnitude)) / 8 + 1;
}

/// Appends elements to a buffer of fixed size. Writing beyond it is not done and remembered: the caller checks ok()
/// once.
class BerWriter {
  public:
    explicit BerWriter(std::span<std::uint8_t> buffer) noexcept : buffer_{buffer} {}

    [[nodiscard]] bool ok() const noexcept { return ok_; }
    [[nodiscard]] std::size_t size() const noexcept { return size_; }

    void octet(std::uint8_t value) noexcept {
        if (std::uint8_t* const to = room(1)) {
            *to = value;
        }
    }
    void octets(Octets values) noexcept {
        if (std::uint8_t* const to = room(values.size()); to != nullptr && !values.empty()) {
            std::memcpy(to, values.data(), values.size());
        }
    }
    /// The `count` low octets of `value`, most significant first; octets above the eighth are `fill`.
    void integer(std::uint64_t value, std::size_t count, std::uint8_t fill = 0) noexcept {
        for (std::size_t i = count; i-- > 0;) {
            octet(i < 8 ? static_cast<std::uint8_t>(value >> (8 * i)) : fill);
        }
    }
    void head(std::uint8_t tag, std::size_t length) noexcept {
        octet(tag);
        std::size_t const form = length_octets(length);
        if (form > 1) {
            octet(static_cast<std::uint8_t>(0x80U | (form - 1)));
        }
        integer(length, form == 1 ? 1 : form - 1);
    }
    void element(std::uint8_t tag, Octets value) noexcept {
        head(tag, value.size());
        octets(value);
    }

  private:
    std::uint8_t* room(std::size_t count) noexcept {
        if (!ok_ || buffer_.size() - size_ < count) {
            ok_ = false;
            return nullptr;
        }
        std::uint8_t* const to = buffer_.data() + size_;
        size_ += count;
        return to;
    }

    std::span<std::uint8_t> buffer_;
    std::size_t size_{0};
    bool ok_{true};
};

} // namespace gridspace::iec61850
