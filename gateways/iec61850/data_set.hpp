// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/basic_type.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::iec61850 {

/// A member of a data set: a basic value, or a structure or array of members.
struct DataNode {
    enum class Kind : std::uint8_t { leaf, structure, array };

    std::string name;
    Kind kind{Kind::leaf};
    BasicType type{BasicType::boolean}; ///< of a leaf
    std::uint16_t length{
        0}; ///< of a leaf: largest octets of a string, bits of a bit string; 0: the default of the type
    std::vector<DataNode> members;

    [[nodiscard]] static DataNode leaf(std::string name, BasicType type, std::uint16_t length = 0) {
        return {std::move(name), Kind::leaf, type, length, {}};
    }
    friend bool operator==(DataNode const&, DataNode const&) = default;
};

/// The members of a GOOSE or SV data set, in the order of the wire.
struct DataSet {
    std::vector<DataNode> members;
    friend bool operator==(DataSet const&, DataSet const&) = default;
};

/// A basic value of a data set. Leaves are counted depth first; "mag.f" is f in the structure mag, "harm.2" the third
/// of an array.
struct Leaf {
    std::string name;
    BasicType type{BasicType::boolean};
    std::uint16_t length{0}; ///< filled in: default_length() where the data set gives none
};
[[nodiscard]] std::vector<Leaf> leaves_of(DataSet const& data_set);

/// The timestamp `t` in the same structure as a leaf: "Op.t" for "Op.general", "t" for "trip".
[[nodiscard]] std::optional<std::size_t> time_next_to(std::vector<Leaf> const& leaves, std::size_t leaf);

/// Largest octets of strings (35 and 20, as IEC 61850-9-2 reserves them), bits of a bit string (32); 0 for other types.
[[nodiscard]] std::uint16_t default_length(BasicType type) noexcept;

/// 9-2LE "PhsMeas1": Ia Ib Ic In Va Vb Vc Vn as INT32 (1 mA, 10 mV), each with its quality.
[[nodiscard]] DataSet data_set_92le();

} // namespace gridspace::iec61850
