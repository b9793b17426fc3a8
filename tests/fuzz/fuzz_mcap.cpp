// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Any file is read as a recording.
#include "recorder/mcap/mcap_reader.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <sys/mman.h>
#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
    static int const fd = ::memfd_create("fuzz", MFD_CLOEXEC);
    if (::ftruncate(fd, 0) != 0 || ::pwrite(fd, data, size, 0) != static_cast<ssize_t>(size)) {
        std::abort();
    }
    std::uint64_t seen = 0;
    auto const outcome =
        gridspace::mcap::read_messages("/proc/self/fd/" + std::to_string(fd), [&](gridspace::mcap::Message const& m) {
            ++seen;
            return m.channel.topic != "stop" && m.data.size() <= size + (256U << 20U);
        });
    if (outcome && (outcome->messages != seen || (!outcome->complete && outcome->note.empty()))) {
        std::abort(); // what was lost must be said
    }
    return 0;
}
