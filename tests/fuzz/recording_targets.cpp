// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// IDL, CDR and recordings of strangers: the recorder, the monitor and the verbs on a run read them.
#include "common/idl/cdr_visitor.hpp"
#include "common/idl/key.hpp"
#include "recorder/mcap/mcap_reader.hpp"
#include "targets.hpp"

#include <algorithm>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>
#include <sys/mman.h>
#include <unistd.h>

namespace gridspace::fuzz {

void idl(std::uint8_t const* data, std::size_t size) {
    using namespace gridspace::idl;
    struct Count final : Visitor {
        void leaf(std::string_view path, Type const&, Value const& value) override {
            octets += path.size() + to_text(value).size();
        }
        std::size_t octets{0};
    } count;
    std::string_view const all{reinterpret_cast<char const*>(data), size};
    std::size_t const cut = std::min(all.find('\0'), all.size());
    auto const model = parse(all.substr(0, cut));
    if (!model) {
        return;
    }
    auto const sample = std::as_bytes(std::span{data, size}).subspan(std::min(size, cut + 1));
    for (std::size_t i = 0; i < std::min<std::size_t>(model->types.size(), 16); ++i) {
        (void)visit(*model, i, sample, count);
        (void)find_integer(*model, i, sample, "time_ns");
        (void)model->is_keyed(i);
        (void)KeyFinder{*model, i}.key_of(sample);
    }
}

void mcap(std::uint8_t const* data, std::size_t size) {
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
}

} // namespace gridspace::fuzz
