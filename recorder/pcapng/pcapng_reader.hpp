// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "recorder/pcapng/pcapng_writer.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace gridspace::pcapng {

inline constexpr std::uint16_t kEthernetLink = 1;

struct Interface {
    std::string name, description;
    std::uint16_t link_type{kEthernetLink};
    std::uint64_t units_per_s{1'000'000};
};

/// Whether a point of a run's capture is in the middle of a cable ("process_bus/mu21:near_unit"): the same frames, as
/// far as they went on, are seen again where the cable ends.
[[nodiscard]] inline bool is_inside_a_cable(std::string_view point) {
    auto const slash = point.find('/');
    return slash != std::string_view::npos && point.find(':', slash) != std::string_view::npos;
}

/// Where the capture of a run is: bus.pcapng.gz of its folder, or bus.pcapng where it is not compressed.
[[nodiscard]] std::filesystem::path capture_of_run(std::filesystem::path const& folder);

struct Frame {
    std::uint32_t interface{0};
    std::int64_t time_ns{0}; ///< since 1970
    std::vector<std::uint8_t> octets;
    std::uint32_t original_octets{0}; ///< more than octets.size() when the capture was cut
    std::string comment;
    Direction direction{Direction::unknown};
};

/// Reads captures frame by frame: pcapng (enhanced, simple and the old packet blocks) and classic pcap (micro- and
/// nanoseconds, and the "modified" one of A. Kuznetzov, 0xa1b2cd34), either byte order, also compressed by gzip. Memory
/// is bounded by one block, at most 16 MB, and 65,536 interfaces. A compressed file may become 256 MiB, and 200 octets
/// for each of its own. A file that was cut off in the middle (a crash, a full disk) gives its whole
/// frames and `truncated()`.
class Reader {
  public:
    [[nodiscard]] static Result<Reader> open(std::filesystem::path const& file);

    /// The next frame; nothing at the end. The error names the file and the offset.
    [[nodiscard]] Result<std::optional<Frame>> next();
    /// All that are left, to `on_frame(Frame&&)`.
    template <class OnFrame>
    [[nodiscard]] Result<void> each(OnFrame const& on_frame) {
        for (;;) {
            auto frame = next();
            if (!frame) {
                return std::unexpected{frame.error()};
            }
            if (!*frame) {
                return {};
            }
            on_frame(std::move(**frame));
        }
    }
    [[nodiscard]] std::vector<Interface> const& interfaces() const { return interfaces_; }
    [[nodiscard]] bool truncated() const { return truncated_; }

  private:
    struct Close {
        void operator()(void* file) const;
    };
    Reader() = default;

    template <class T>
    [[nodiscard]] T number(std::uint8_t const* from) const;
    /// Fills `block_` with so many octets; false at the end of the file, or of what can be decompressed.
    [[nodiscard]] bool read(std::size_t octets);
    [[nodiscard]] Result<std::optional<Frame>> next_frame();
    [[nodiscard]] std::unexpected<Error> damaged(std::string const& what) const;
    [[nodiscard]] std::unexpected<Error> not_decompressed() const;
    [[nodiscard]] Result<std::optional<Frame>> next_classic();
    [[nodiscard]] Result<void> section_header(std::uint32_t length);
    [[nodiscard]] Result<void> interface_block();
    [[nodiscard]] Result<std::optional<Frame>> packet_block(std::uint32_t type);
    void packet_options(Frame& frame, std::size_t at) const;

    std::unique_ptr<void, Close> file_; ///< zlib's, which reads what is not compressed as it is
    std::string name_;
    std::uint64_t offset_{0}, left_{0}; ///< octets of the file that were not read, or may still be decompressed
    std::string broken_;                ///< what is wrong with its compression
    bool too_large_{false};             ///< it is that it becomes too large
    bool compressed_{false}, begun_{false};
    bool classic_{false}, swapped_{false}, truncated_{false};
    std::size_t record_head_{16}; ///< of a classic file: the "modified" one says 8 octets more, which nobody needs
    std::vector<Interface> interfaces_;
    std::vector<std::uint8_t> block_;  ///< body of the current block, without its head and its trailing length
    std::uint32_t first_interface_{0}; ///< of the current section
};

} // namespace gridspace::pcapng
