// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/merge.hpp"
#include "common/config/yaml.hpp"
#include "gateways/streams/stream.hpp"
#include "recorder/pcapng/pcapng_reader.hpp"
#include "targets.hpp"

#include <string>
#include <sys/mman.h>
#include <unistd.h>

namespace gridspace::fuzz {

void pcapng(std::uint8_t const* data, std::size_t size) {
    int const fd = ::memfd_create("capture", MFD_CLOEXEC);
    require(fd >= 0 && ::write(fd, data, size) == static_cast<ssize_t>(size), "no memory file");
    auto reader = pcapng::Reader::open("/proc/self/fd/" + std::to_string(fd));
    std::size_t frames = 0;
    while (reader) {
        auto const frame = reader->next();
        if (!frame || !*frame) {
            break;
        }
        require(++frames <= size && (*frame)->octets.size() <= size, "more frames than octets");
    }
    ::close(fd);
}

void streams(std::uint8_t const* data, std::size_t size) {
    std::string const text(reinterpret_cast<char const*>(data), size);
    config::Diagnostics diagnostics;
    auto node = config::parse_yaml(text, config::make_source("fuzz.yaml", text), diagnostics);
    if (node) {
        config::resolve_likes(*node, diagnostics);
        auto const read = streams::read_streams(*node, diagnostics);
        require(!diagnostics.ok() || read.size() == node->entries.size(), "a stream disappeared without a word");
    }
    (void)diagnostics.render();
}

} // namespace gridspace::fuzz
