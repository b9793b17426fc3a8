// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/mapping/record_type.hpp"

#include <cstddef>
#include <span>

namespace gridspace::mapping {

/// Reads samples of a record type from CDR. Never reads outside of the sample; allocates nothing.
class RecordReader {
  public:
    /// `type` must outlive it.
    explicit RecordReader(RecordType const& type) : type_{type} {}

    /// Reads every field outside of the `each` sequence into `values` (one per field of the type). A field of an
    /// element that the sample does not have is zero, and counted. False when the sample does not fit the type. Texts
    /// point into `cdr`, which must stay until the last next().
    [[nodiscard]] bool read(std::span<std::byte const> cdr, std::span<Value> values) noexcept;
    /// Elements of `each` in this sample.
    [[nodiscard]] std::size_t elements() const noexcept { return elements_; }
    /// Reads the next element of `each` into its fields. False after the last.
    [[nodiscard]] bool next(std::span<Value> values) noexcept;

    [[nodiscard]] std::uint64_t absent() const noexcept { return absent_; } ///< elements that were mapped and not there

  private:
    [[nodiscard]] bool walk(RecordType::Node const& node, std::uint32_t field, std::span<Value> values) noexcept;
    [[nodiscard]] bool sequence(RecordType::Node const& node, std::uint32_t field, std::span<Value> values) noexcept;
    [[nodiscard]] bool leaf(RecordType::Node const& node, std::uint32_t field, std::span<Value> values) noexcept;
    [[nodiscard]] bool raw(std::uint32_t octets, std::uint64_t& bits) noexcept;
    void clear(std::uint32_t first, std::uint32_t count, std::span<Value> values) noexcept;

    RecordType const& type_;
    std::span<std::byte const> data_;
    std::size_t at_{0}, each_at_{0}, steps_{0};
    std::size_t elements_{0}, given_{0};
    std::uint64_t absent_{0};
    bool little_{true};
    RecordType::Node const* each_{nullptr};
};

} // namespace gridspace::mapping
