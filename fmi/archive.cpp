// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/archive.hpp"

#include "fmi/archive_memory.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <optional>

namespace gridspace::fmi {

struct Archive::Opened {
    std::string name;
    std::vector<std::byte> octets; ///< of a file; empty when somebody else has them
    ZipInMemory memory;
    unzFile zip{nullptr};
    std::vector<Entry> entries;
    std::map<std::string, unz64_file_pos, std::less<>> places;

    Opened() = default;
    Opened(Opened const&) = delete;
    Opened& operator=(Opened const&) = delete;
    ~Opened() {
        if (zip != nullptr) {
            unzClose(zip);
        }
    }
};

namespace {

constexpr std::string_view kMakeAgain = "export the FMU again, or ask whoever made it";
constexpr unsigned kTypeMask = 0170000, kRegular = 0100000, kFolderType = 0040000; // of st_mode, in zip files of Unix

/// Why a name cannot be a file below a folder; nothing when it can.
std::optional<std::string_view> refuse_name(std::string_view name) {
    if (name.empty() || name.size() > Archive::kLongestName) {
        return "has no name, or one that is too long";
    }
    if (std::any_of(name.begin(), name.end(),
                    [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; })) {
        return "has control characters in its name";
    }
    if (name.find('\\') != std::string_view::npos) {
        return "has a backslash in its name, and folders are parted by '/'";
    }
    if (name.front() == '/' || (name.size() > 1 && name[1] == ':')) {
        return "has an absolute path";
    }
    std::string_view rest = name.ends_with('/') ? name.substr(0, name.size() - 1) : name;
    while (true) {
        std::size_t const slash = rest.find('/');
        std::string_view const part = rest.substr(0, slash);
        if (part.empty() || part == "." || part == "..") {
            return "leaves the folder that it is unpacked into";
        }
        if (slash == std::string_view::npos) {
            return std::nullopt;
        }
        rest.remove_prefix(slash + 1);
    }
}

/// Why an entry is not taken, apart from its name.
std::optional<std::string> refuse_entry(unz_file_info64 const& info) {
    constexpr uLong kStored = 0, kDeflated = 8, kEncrypted = 1, kUnix = 3;
    if ((info.flag & kEncrypted) != 0) {
        return "is encrypted";
    }
    if (info.compression_method != kStored && info.compression_method != kDeflated) {
        return fmt::format("is compressed by method {}, and an FMU is stored or deflated", info.compression_method);
    }
    unsigned const type = (info.external_fa >> 16U) & kTypeMask;
    if ((info.version >> 8U) == kUnix && type != 0 && type != kRegular && type != kFolderType) {
        return "is no file and no folder, but a link or a device";
    }
    return std::nullopt;
}

} // namespace

Archive::Archive(std::unique_ptr<Opened> opened) : opened_{std::move(opened)} {}
Archive::~Archive() = default;
Archive::Archive(Archive&&) noexcept = default;
Archive& Archive::operator=(Archive&&) noexcept = default;

Result<Archive> Archive::open(std::span<std::byte const> octets, std::string name) {
    auto opened = std::make_unique<Opened>();
    opened->name = std::move(name);
    opened->memory.octets = octets;
    opened->zip = open_zip(opened->memory);
    auto const refuse = [&](std::string const& what, std::string_view remedy = kMakeAgain) {
        return fail(ExitCode::usage, fmt::format("{}: {}", opened->name, what), std::string{remedy});
    };
    if (opened->zip == nullptr) {
        return refuse("it is no zip file, and an FMU is one",
                      "is it complete? expected a file made by an FMI exporter");
    }
    std::uint64_t total = 0;
    for (int code = unzGoToFirstFile(opened->zip); code != UNZ_END_OF_LIST_OF_FILE;
         code = unzGoToNextFile(opened->zip)) {
        unz_file_info64 info{};
        std::array<char, kLongestName + 2> text{};
        unz64_file_pos place{};
        if (code != UNZ_OK ||
            unzGetCurrentFileInfo64(opened->zip, &info, text.data(), text.size() - 1, nullptr, 0, nullptr, 0) !=
                UNZ_OK ||
            unzGetFilePos64(opened->zip, &place) != UNZ_OK) {
            if (opened->entries.empty() && code != UNZ_OK) {
                return refuse("its table of contents is damaged or empty");
            }
            return refuse("its table of contents is damaged");
        }
        std::string entry{text.data()};
        if (info.size_filename != entry.size()) { // longer than the buffer, or with a NUL in it
            return refuse(fmt::format("the name of its file {} is too long or no text", opened->entries.size() + 1));
        }
        if (auto const why = refuse_name(entry)) {
            return refuse(fmt::format("its file '{}' {}", entry.substr(0, 80), *why));
        }
        if (auto const why = refuse_entry(info)) {
            return refuse(fmt::format("its file '{}' {}", entry, *why));
        }
        total += std::min<std::uint64_t>(info.uncompressed_size, kMostOctets + 1);
        if (total > kMostOctets || opened->entries.size() >= kMostEntries) {
            return refuse(fmt::format("it unpacks to more than {} MB or {} files", kMostOctets >> 20U, kMostEntries));
        }
        if (!opened->places.emplace(entry, place).second) {
            return refuse(fmt::format("it has two files '{}'", entry));
        }
        opened->entries.push_back({std::move(entry), info.uncompressed_size});
    }
    return Archive{std::move(opened)};
}

Result<Archive> Archive::open(std::filesystem::path const& file) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) {
        bool const folder = std::filesystem::is_directory(file, ignored);
        return fail(ExitCode::usage, fmt::format("cannot read '{}'", file.string()),
                    folder ? "it is a folder; expected the FMU as a zip file" : "there is no such file");
    }
    if (std::filesystem::file_size(file, ignored) > kMostOctets) { // what failed is larger too
        return fail(ExitCode::usage, fmt::format("{}: it is larger than {} MB", file.string(), kMostOctets >> 20U));
    }
    std::vector<std::byte> kept(static_cast<std::size_t>(std::filesystem::file_size(file, ignored)));
    std::ifstream in{file, std::ios::binary};
    in.read(reinterpret_cast<char*>(kept.data()), static_cast<std::streamsize>(kept.size()));
    if (!in.good()) {
        return fail(ExitCode::usage, fmt::format("cannot read '{}'", file.string()));
    }
    auto out = open(std::span<std::byte const>{kept}, file.string());
    if (out) {
        out->opened_->octets = std::move(kept); // moved: the octets stay where they are
    }
    return out;
}

std::vector<Archive::Entry> const& Archive::entries() const {
    return opened_->entries;
}

bool Archive::has(std::string_view entry) const {
    return opened_->places.contains(entry);
}

Result<std::string> Archive::read(std::string_view entry, std::uint64_t most) const {
    auto const refuse = [&](std::string_view what) {
        return fail(ExitCode::usage, fmt::format("{}: its file '{}' {}", opened_->name, entry, what),
                    std::string{kMakeAgain});
    };
    auto const place = opened_->places.find(entry);
    if (place == opened_->places.end()) {
        return refuse("is missing");
    }
    unz64_file_pos at = place->second;
    unz_file_info64 info{};
    if (unzGoToFilePos64(opened_->zip, &at) != UNZ_OK ||
        unzGetCurrentFileInfo64(opened_->zip, &info, nullptr, 0, nullptr, 0, nullptr, 0) != UNZ_OK ||
        unzOpenCurrentFile(opened_->zip) != UNZ_OK) {
        return refuse("is damaged");
    }
    std::string out;
    std::array<char, 65536> block{};
    int size = 0;
    bool too_long = info.uncompressed_size > most;
    while (!too_long && (size = unzReadCurrentFile(opened_->zip, block.data(), block.size())) > 0) {
        out.append(block.data(), static_cast<std::size_t>(size));
        too_long = out.size() > info.uncompressed_size;
    }
    bool const sound = unzCloseCurrentFile(opened_->zip) == UNZ_OK && size == 0 && out.size() == info.uncompressed_size;
    if (too_long) {
        return refuse(fmt::format("has more than {} octets", std::min<std::uint64_t>(most, info.uncompressed_size)));
    }
    return sound ? Result<std::string>{std::move(out)} : refuse("is damaged");
}

Result<void> Archive::unpack(std::filesystem::path const& folder) const {
    namespace fs = std::filesystem;
    for (Entry const& entry : opened_->entries) {
        fs::path const target = folder / entry.name;
        std::error_code failed;
        fs::create_directories(entry.is_folder() ? target : target.parent_path(), failed);
        if (!failed && !entry.is_folder()) {
            auto const content = read(entry.name);
            if (!content) {
                return std::unexpected{content.error()};
            }
            std::ofstream out{target, std::ios::binary};
            out << *content << std::flush;
            failed = out.good() ? std::error_code{} : std::make_error_code(std::errc::io_error);
        }
        if (failed) {
            return fail(ExitCode::environment, fmt::format("{}: cannot write '{}'", opened_->name, target.string()),
                        "is the disk full, or is it a file and a folder at once?");
        }
    }
    return {};
}

} // namespace gridspace::fmi
