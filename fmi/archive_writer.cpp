// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/archive_writer.hpp"

#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <memory>
#include <minizip/zip.h>

namespace gridspace::fmi {
namespace {

/// A zip file that grows in memory, in minizip's calls and types: `opaque` is the memory, `stream` as well.
struct GrowingZip {
    std::string octets;
    std::uint64_t at{0};
};

GrowingZip& growing(void* opaque) {
    return *static_cast<GrowingZip*>(opaque);
}
voidpf open_growing(voidpf opaque, void const*, int) {
    return opaque;
}
uLong read_growing(voidpf, voidpf, void*, uLong) {
    return 0;
}
uLong write_growing(voidpf opaque, voidpf, void const* data, uLong size) {
    GrowingZip& zip = growing(opaque);
    zip.octets.resize(std::max<std::uint64_t>(zip.octets.size(), zip.at + size));
    std::copy_n(static_cast<char const*>(data), size, zip.octets.data() + zip.at);
    zip.at += size;
    return size;
}
ZPOS64_T tell_growing(voidpf opaque, voidpf) {
    return growing(opaque).at;
}
long seek_growing(voidpf opaque, voidpf, ZPOS64_T offset, int origin) {
    GrowingZip& zip = growing(opaque);
    std::uint64_t const from = origin == ZLIB_FILEFUNC_SEEK_SET   ? 0
                               : origin == ZLIB_FILEFUNC_SEEK_CUR ? zip.at
                                                                  : zip.octets.size();
    std::uint64_t const to = from + offset; // unsigned: what wraps around is too large or right
    if (to > zip.octets.size()) {
        return -1;
    }
    zip.at = to;
    return 0;
}
int close_growing(voidpf, voidpf) {
    return 0;
}
int error_of_growing(voidpf, voidpf) {
    return 0;
}

/// 1 January 1980, where the time of zip files begins.
constexpr uLong kBeginning = (1U << 21U) | (1U << 16U);

int add(zipFile zip, ArchiveFile const& file) {
    zip_fileinfo info{};
    info.dosDate = kBeginning;
    int code = zipOpenNewFileInZip64(zip, file.name.c_str(), &info, nullptr, 0, nullptr, 0, nullptr, Z_DEFLATED,
                                     Z_DEFAULT_COMPRESSION, 0);
    if (code == ZIP_OK && !file.content.empty()) {
        code = zipWriteInFileInZip(zip, file.content.data(), static_cast<unsigned>(file.content.size()));
    }
    return code == ZIP_OK ? zipCloseFileInZip(zip) : code;
}

} // namespace

Result<std::string> make_archive(std::vector<ArchiveFile> const& files) {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 30U; // what Archive::open takes of all files together
    GrowingZip memory;
    zlib_filefunc64_def calls{open_growing, read_growing,  write_growing,    tell_growing,
                              seek_growing, close_growing, error_of_growing, &memory};
    zipFile const zip = zipOpen2_64("", APPEND_STATUS_CREATE, nullptr, &calls);
    if (zip == nullptr) {
        return fail(ExitCode::environment, "no zip file can be made", "is there enough memory?");
    }
    std::uint64_t total = 0;
    Result<void> ok;
    for (ArchiveFile const& file : files) {
        total += file.content.size();
        if (total > kMost) {
            ok = fail(ExitCode::usage, fmt::format("the files of the FMU are more than {} MB", kMost >> 20U));
        } else if (int const code = add(zip, file); code != ZIP_OK) {
            ok = fail(ExitCode::environment,
                      fmt::format("'{}' cannot be put into the zip file (minizip {})", file.name, code));
        }
        if (!ok) {
            break;
        }
    }
    if (zipClose(zip, nullptr) != ZIP_OK && ok) {
        ok = fail(ExitCode::environment, "the zip file cannot be completed");
    }
    return ok ? Result<std::string>{std::move(memory.octets)} : std::unexpected{ok.error()};
}

} // namespace gridspace::fmi
