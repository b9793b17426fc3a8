// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/archive_memory.hpp"

#include <algorithm>
#include <cstring>

namespace gridspace::fmi {
namespace {

// minizip's calls, in its types: `opaque` is the memory, `stream` as well.
ZipInMemory& memory_of(void* opaque) {
    return *static_cast<ZipInMemory*>(opaque);
}

voidpf open_it(voidpf opaque, void const*, int mode) {
    return (mode & ZLIB_FILEFUNC_MODE_WRITE) == 0 ? opaque : nullptr;
}

uLong read_it(voidpf opaque, voidpf, void* out, uLong size) {
    ZipInMemory& memory = memory_of(opaque);
    std::uint64_t const left = memory.octets.size() - std::min<std::uint64_t>(memory.at, memory.octets.size());
    auto const count = static_cast<std::size_t>(std::min<std::uint64_t>(size, left));
    if (count > 0) {
        std::memcpy(out, memory.octets.data() + memory.at, count);
    }
    memory.at += count;
    memory.cut_short = memory.cut_short || count < size;
    return static_cast<uLong>(count);
}

uLong write_it(voidpf, voidpf, void const*, uLong) {
    return 0;
}

ZPOS64_T tell_it(voidpf opaque, voidpf) {
    return memory_of(opaque).at;
}

long seek_it(voidpf opaque, voidpf, ZPOS64_T offset, int origin) {
    ZipInMemory& memory = memory_of(opaque);
    std::uint64_t const from = origin == ZLIB_FILEFUNC_SEEK_SET   ? 0
                               : origin == ZLIB_FILEFUNC_SEEK_CUR ? memory.at
                                                                  : memory.octets.size();
    std::uint64_t const to = from + offset; // unsigned: what wraps around is too large or right
    if (to > memory.octets.size()) {
        return -1;
    }
    memory.at = to;
    return 0;
}

int close_it(voidpf, voidpf) {
    return 0;
}

int error_of(voidpf opaque, voidpf) {
    return memory_of(opaque).cut_short ? 1 : 0; // minizip takes the end of a file for success
}

} // namespace

unzFile open_zip(ZipInMemory& memory) {
    zlib_filefunc64_def calls{open_it, read_it, write_it, tell_it, seek_it, close_it, error_of, &memory};
    return unzOpen2_64("", &calls);
}

} // namespace gridspace::fmi
