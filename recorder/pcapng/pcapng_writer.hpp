// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/unique_fd.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace gridspace::pcapng {

/// Which way a frame went, as seen from the interface.
enum class Direction : std::uint8_t { unknown = 0, inbound = 1, outbound = 2 };

/// Writes a capture file (pcapng 1.0, little-endian, Ethernet) with stamps in nanoseconds; compressed (RFC 1952) when
/// its name ends with ".gz". The same calls give the same octets. Memory is bounded by the buffer; what was flushed
/// survives a crash.
class Writer {
  public:
    ~Writer();
    Writer(Writer&&) noexcept;
    Writer& operator=(Writer&&) noexcept;

    /// `application`: what wrote the file, for people.
    [[nodiscard]] static Result<Writer> create(std::filesystem::path const& file, std::string_view application);

    /// An interface (a port of a switch, a link); its number is for write().
    [[nodiscard]] std::uint32_t add_interface(std::string_view name, std::string_view description = {});

    /// A frame. `time_ns` since 1970; `comment`: shown with it, empty for none.
    [[nodiscard]] Result<void> write(std::uint32_t interface, std::int64_t time_ns, std::span<std::uint8_t const> frame,
                                     std::string_view comment = {}, Direction direction = Direction::unknown);
    /// How many frames an interface has seen and lost; written at any time, usually last.
    [[nodiscard]] Result<void> statistics(std::uint32_t interface, std::int64_t time_ns, std::uint64_t received,
                                          std::uint64_t dropped);
    [[nodiscard]] Result<void> flush();
    [[nodiscard]] Result<void> close();
    [[nodiscard]] std::uint64_t frames() const { return frames_; }

  private:
    class Gzip;
    Writer(UniqueFd fd, std::filesystem::path file);
    [[nodiscard]] Result<void> flush_when_full();
    [[nodiscard]] Result<void> put(std::span<std::uint8_t const> octets);

    UniqueFd fd_;
    std::unique_ptr<Gzip> gzip_; ///< where it is compressed
    std::filesystem::path file_;
    std::vector<std::uint8_t> buffer_;
    std::uint32_t interfaces_{0};
    std::uint64_t frames_{0};
};

} // namespace gridspace::pcapng
