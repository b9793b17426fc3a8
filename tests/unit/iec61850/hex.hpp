// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/goose_template.hpp"
#include "gateways/iec61850/sv_layout.hpp"
#include "gateways/iec61850/sv_template.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace gridspace::iec61850 {

using Buffer = std::vector<std::uint8_t>;

/// "81 00 8000" to octets; blanks are skipped.
inline Buffer from_hex(std::string_view text) {
    Buffer out;
    int high = -1;
    for (char const c : text) {
        if (c == ' ') {
            continue;
        }
        int const digit = c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10;
        if (high < 0) {
            high = digit;
        } else {
            out.push_back(static_cast<std::uint8_t>(high * 16 + digit));
            high = -1;
        }
    }
    return out;
}

inline std::string to_hex(Octets octets) {
    constexpr char kDigits[] = "0123456789abcdef";
    std::string out;
    for (std::uint8_t const octet : octets) {
        out.push_back(kDigits[octet >> 4U]);
        out.push_back(kDigits[octet & 15U]);
    }
    return out;
}

inline Buffer concat(Buffer a, Buffer const& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

inline Buffer addresses() {
    return from_hex("010ccd040021 020000000001");
}

/// From the TPID on, as an independent peer sent them.
inline constexpr std::string_view kGoldenGoose =
    "81008000 88b8 8001 0048 0000 0000 613e 800b412f4c4c4e3024474f2467 810106"
    "8208412f4c4c4e302464 830147 8408 5de2ff8000000018 850102 860100 870100"
    "880101 890100 8a0101 ab03 830101";
inline constexpr std::string_view kGoldenSv =
    "81008000 88ba 4000 0036 0000 0000 602c 800101 a227 3025 8008544c31314d553031"
    "820212bf 830400000001 850102 870c 3f800000 bf000000 bf000000";

inline Address sv_address() {
    return {*Mac::parse("01:0C:CD:04:00:21"), *Mac::parse("02-00-00-00-00-01"), VlanTag{}, 0x4000, false};
}

inline DataSet three_currents() {
    return {{DataNode::leaf("Ia", BasicType::float32), DataNode::leaf("Ib", BasicType::float32),
             DataNode::leaf("Ic", BasicType::float32)}};
}

inline AsduDescription asdu(std::string sv_id, std::size_t sample_octets) {
    AsduDescription out;
    out.sv_id = std::move(sv_id);
    out.sample_octets = sample_octets;
    return out;
}

inline GooseDescription one_boolean() {
    GooseDescription out;
    out.gocb_ref = "A/LLN0$GO$g";
    out.dat_set = "A/LLN0$d";
    out.go_id = "G";
    out.data_set = {{DataNode::leaf("status", BasicType::boolean)}};
    return out;
}

} // namespace gridspace::iec61850
