// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/unique_fd.hpp"
#include "recorder/mcap/mcap_format.hpp"

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace gridspace::mcap {

/// Writes an MCAP file in compressed chunks, with an index at the end. What has been written as chunks survives a
/// crash: readers use the prefix. Memory is bounded, however long the recording is: what the index needs is kept in a
/// file without a name. Errors (disk full) are returned and stay.
class Writer {
  public:
    struct Options {
        bool compress{true};                   ///< zstd
        std::size_t chunk_octets{1024 * 1024}; ///< of uncompressed records
    };
    [[nodiscard]] static Result<Writer> create(std::filesystem::path const& file, Options options);
    [[nodiscard]] static Result<Writer> create(std::filesystem::path const& file) { return create(file, Options{}); }

    [[nodiscard]] std::uint16_t add_schema(std::string name, std::string encoding, std::string data);
    [[nodiscard]] std::uint16_t add_channel(std::uint16_t schema, std::string topic, std::string message_encoding,
                                            std::map<std::string, std::string> metadata);
    [[nodiscard]] Result<void> write(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
                                     std::span<std::byte const> data);
    /// Ends the open chunk, so that what was written so far is on disk.
    [[nodiscard]] Result<void> flush();
    /// Writes the index: the file can be read as a whole. Without it, it is as after a crash. Nothing can be written
    /// any more; later calls do nothing.
    [[nodiscard]] Result<void> finish();
    /// Finishes the file and waits for the disk, for as long as that takes. Later calls do nothing.
    [[nodiscard]] Result<void> close();

    [[nodiscard]] std::uint64_t messages() const { return message_count_; }
    [[nodiscard]] std::uint64_t octets() const { return position_; }

  private:
    Writer(UniqueFd fd, std::filesystem::path file, Options options);
    [[nodiscard]] Result<void> put(std::vector<std::uint8_t> const& bytes);
    void spill_index();
    [[nodiscard]] Result<void> put_index();
    [[nodiscard]] std::vector<std::uint8_t> statistics_body() const;

    UniqueFd fd_;
    std::filesystem::path file_;
    Options options_;
    std::uint64_t position_{0};
    std::vector<Schema> schemas_;
    std::vector<Channel> channels_;
    std::vector<std::uint8_t> chunk_;
    std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_messages_; ///< (time, offset)
    bool chunk_has_messages_{false};
    std::uint64_t chunk_start_{0}, chunk_end_{0};
    std::uint32_t chunk_count_{0};
    std::vector<std::uint8_t> index_; ///< records of the chunks' index that are not in `spilled_` yet
    UniqueFd spilled_;                ///< a file without a name, next to the recording; none while the index is short
    std::map<std::uint16_t, std::uint64_t> channel_counts_;
    std::uint64_t message_count_{0};
    std::uint64_t first_time_{0}, last_time_{0};
    bool failed_{false}, finished_{false};
};

} // namespace gridspace::mcap
