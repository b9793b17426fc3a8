// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::fmi {

/// The zip file that an FMU is. It comes from somebody else: open() judges the whole table of contents, and what is
/// read is never more than that says.
class Archive {
  public:
    static constexpr std::uint64_t kMostOctets = std::uint64_t{1} << 30U; ///< of all files together, unpacked
    static constexpr std::size_t kMostEntries = 20'000;
    static constexpr std::size_t kLongestName = 512;

    struct Entry {
        std::string name; ///< relative, with '/'; that of a folder ends with it
        std::uint64_t octets{0};
        [[nodiscard]] bool is_folder() const { return name.ends_with('/'); }
    };

    /// `name` is what messages call the file. Refused: names that leave the folder, links and devices, encryption,
    /// compression other than deflate, two entries of one name, more than is said above.
    [[nodiscard]] static Result<Archive> open(std::span<std::byte const> octets, std::string name);
    [[nodiscard]] static Result<Archive> open(std::filesystem::path const& file);
    ~Archive();
    Archive(Archive&&) noexcept;
    Archive& operator=(Archive&&) noexcept;

    [[nodiscard]] std::vector<Entry> const& entries() const;
    [[nodiscard]] bool has(std::string_view entry) const;
    /// The content of an entry, its checksum verified. `most`: more octets than that are refused.
    [[nodiscard]] Result<std::string> read(std::string_view entry, std::uint64_t most = kMostOctets) const;
    /// All of it into `folder`, which is made.
    [[nodiscard]] Result<void> unpack(std::filesystem::path const& folder) const;

  private:
    struct Opened;
    explicit Archive(std::unique_ptr<Opened> opened);
    std::unique_ptr<Opened> opened_;
};

} // namespace gridspace::fmi
