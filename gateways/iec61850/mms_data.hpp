// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/basic_type.hpp"
#include "gateways/iec61850/ber.hpp"

#include <array>

namespace gridspace::iec61850 {

/// Structures and arrays may be nested this deep; real data sets need two or three levels.
inline constexpr std::size_t kMaxDepth = 16;

/// Tags of MMS Data (ISO 9506-2) in allData.
namespace data_tag {
inline constexpr std::uint32_t kArray = 0xA1, kStructure = 0xA2, kBoolean = 0x83, kBitString = 0x84, kInteger = 0x85,
                               kUnsigned = 0x86, kFloat = 0x87, kOctetString = 0x89, kVisibleString = 0x8A,
                               kTimeOfDay = 0x8C, kMmsString = 0x90, kUtcTime = 0x91;
} // namespace data_tag

[[nodiscard]] constexpr bool is_container(std::uint32_t tag) noexcept {
    return tag == data_tag::kArray || tag == data_tag::kStructure;
}

/// Walks over all elements of allData, depth first: a container comes before its members. Bounded memory, no recursion.
class DataWalker {
  public:
    DataWalker(Octets all_data, std::uint32_t offset) noexcept;

    /// False at the end, and after an error (see error()). Values of known types have been checked for their length.
    [[nodiscard]] bool next(Tlv& out) noexcept;
    [[nodiscard]] DecodeError error() const noexcept { return error_; }
    /// Containers around the element that next() gave: 0 for a member of the data set.
    [[nodiscard]] std::size_t depth() const noexcept { return depth_; }

  private:
    std::array<BerCursor, kMaxDepth + 1> stack_;
    std::size_t level_{0}, depth_{0};
    DecodeError error_{};
};

/// Checks all of allData; the number of members at the top.
[[nodiscard]] Decoded<std::uint32_t> check_data(Octets all_data, std::uint32_t offset) noexcept;

/// Reads an element as a value of the type that is expected there; nothing when it is of another type or out of its
/// range. Integers are accepted as signed or unsigned when the value fits.
[[nodiscard]] std::optional<Value> read_data_value(Tlv const& element, BasicType type) noexcept;

/// Reads an element by its tag alone; nothing for containers and types that have no place in Value.
[[nodiscard]] std::optional<Value> read_any_data_value(Tlv const& element) noexcept;

/// How integers are written: as short as possible, or always one octet more than the type has (8-1 Ed.2, annex A).
enum class IntegerForm : std::uint8_t { minimal, fixed };

/// Octets of the value's content, without tag and length.
[[nodiscard]] std::size_t data_content_octets(Value const& value, IntegerForm form) noexcept;
/// Writes tag, length and content.
void write_data_value(BerWriter& out, Value const& value, IntegerForm form) noexcept;
[[nodiscard]] std::uint8_t data_tag_of(BasicType type) noexcept;

} // namespace gridspace::iec61850
