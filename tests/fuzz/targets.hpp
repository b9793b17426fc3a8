// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// What is fuzzed, each as a function of any octets. The same functions replay the kept corpus in the ordinary tests
/// (tests/fuzz/replay_test.cpp) and are libFuzzer targets in the preset `fuzz`.
namespace gridspace::fuzz {

void sv(std::uint8_t const* data, std::size_t size);      ///< a frame: decoded, re-encoded, decoded again
void goose(std::uint8_t const* data, std::size_t size);   ///< a frame: decoded, given to a subscriber
void ber(std::uint8_t const* data, std::size_t size);     ///< allData: walked and read as every type
void pcapng(std::uint8_t const* data, std::size_t size);  ///< a capture file
void streams(std::uint8_t const* data, std::size_t size); ///< a `streams:` map as YAML text
void scl(std::uint8_t const* data, std::size_t size);     ///< an SCL file: imported, read as streams, and exported
void mapping(std::uint8_t const* data,
             std::size_t size); ///< the table of a gateway as YAML text, applied when it is valid

/// Ends the program with a message when `ok` is false, also in a build without assertions.
void require(bool ok, char const* what);

} // namespace gridspace::fuzz
