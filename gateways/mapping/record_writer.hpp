// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/mapping/record_type.hpp"

#include <cstddef>
#include <span>

namespace gridspace::mapping {

/// Writes samples of a record type as CDR (little endian, padding zero). Allocates nothing after construction.
class RecordWriter {
  public:
    /// `used`: the fields that will be written, by index. A sequence is as long as its last used element; other fields
    /// are zero, empty, or the first enumerator. `elements`: the most elements of `each` in one sample. `type` must
    /// outlive it.
    RecordWriter(RecordType const& type, std::vector<std::size_t> const& used, std::size_t elements = 0);

    /// Values of all fields, to be written into; they keep what was written before.
    [[nodiscard]] std::span<Value> values() noexcept { return values_; }

    /// Keeps the present values of the fields of `each` as its next element. False when there are as many as it can
    /// hold. Texts must be constants.
    bool append() noexcept;
    [[nodiscard]] std::size_t elements() const noexcept { return elements_; }
    void clear_elements() noexcept { elements_ = 0; }

    /// The sample with its encapsulation header; valid until the next call. Texts that are too long are cut to their
    /// bound.
    [[nodiscard]] std::span<std::byte const> write() noexcept;
    /// The members of the key, big endian without a header, as DDS hashes them; empty without a key. It stands where
    /// write() writes.
    [[nodiscard]] std::span<std::byte const> write_key() noexcept;
    /// A key that is always short goes into the hash as it is; others by MD5.
    [[nodiscard]] bool key_is_short() const noexcept { return key_is_short_; }

  private:
    [[nodiscard]] std::uint32_t length_of(RecordType::Node const& node, std::uint32_t field) const noexcept;
    void walk(RecordType::Node const& node, std::uint32_t field) noexcept;
    void leaf(RecordType::Node const& node, Value const& value) noexcept;
    void number(std::uint64_t bits, std::uint32_t octets) noexcept;
    [[nodiscard]] std::size_t largest(RecordType::Node const& node, std::uint32_t field) const;

    RecordType const& type_;
    std::vector<Value> values_, element_values_;
    std::vector<std::uint32_t> last_used_; ///< by field: the last used one up to it, plus 1; 0: none
    std::size_t capacity_{0}, elements_{0};
    std::vector<std::byte> buffer_;
    std::size_t start_{0}, at_{0}; ///< where alignment counts from; the next octet
    bool only_key_{false}, little_{true}, key_is_short_{false};
};

} // namespace gridspace::mapping
