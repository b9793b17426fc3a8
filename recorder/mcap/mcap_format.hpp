// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

/// MCAP, the container format for recorded messages, version 0 [https://mcap.dev/spec].
namespace gridspace::mcap {

inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

// What is believed of a file. The recorder's own chunks have 1 MiB and a sample more.
inline constexpr std::uint64_t kLargestRecord = 256ULL << 20U; ///< octets in the file
inline constexpr std::uint64_t kLargestChunk = 64ULL << 20U;   ///< octets of one, decompressed
inline constexpr std::uint64_t kDecompressed = 256ULL << 20U;  ///< octets of all chunks together, and
inline constexpr std::uint64_t kDecompressedPerOctet = 200;    ///< so many more for each octet of the file

enum class Op : std::uint8_t {
    header = 0x01,
    footer = 0x02,
    schema = 0x03,
    channel = 0x04,
    message = 0x05,
    chunk = 0x06,
    message_index = 0x07,
    chunk_index = 0x08,
    statistics = 0x0B,
    metadata = 0x0C,
    metadata_index = 0x0D,
    summary_offset = 0x0E,
    data_end = 0x0F,
};

struct Schema {
    std::uint16_t id{0};
    std::string name;
    std::string encoding; ///< "omgidl"
    std::string data;     ///< IDL text
};

struct Channel {
    std::uint16_t id{0};
    std::uint16_t schema_id{0};
    std::string topic;
    std::string message_encoding; ///< "cdr"
    std::map<std::string, std::string> metadata;
};

} // namespace gridspace::mcap
