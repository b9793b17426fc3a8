// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/compare/compare.hpp"
#include "recorder/pcapng/pcapng_reader.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace {

Result<std::uint64_t> compare_captures(std::filesystem::path const& a, std::filesystem::path const& b,
                                       Comparison& into) {
    auto first = pcapng::Reader::open(a), second = pcapng::Reader::open(b);
    for (auto const* reader : {&first, &second}) {
        if (!*reader) {
            return std::unexpected{reader->error()};
        }
    }
    std::uint64_t equal = 0;
    auto const differ = [&](pcapng::Reader const& reader, pcapng::Frame const& frame, std::string what) {
        into.differences.push_back({fmt::format("frame {} of the capture", equal + 1),
                                    reader.interfaces()[frame.interface].name,
                                    static_cast<std::uint64_t>(frame.time_ns), std::move(what)});
        return equal;
    };
    while (true) {
        auto x = first->next(), y = second->next();
        if (!x || !y) {
            return std::unexpected{!x ? x.error() : y.error()};
        }
        if (!*x && !*y) {
            return equal;
        }
        if (!*x || !*y) {
            return differ(*x ? *first : *second, *x ? **x : **y,
                          fmt::format("there is none in {}", (*x ? b : a).string()));
        }
        pcapng::Frame const& f = **x;
        pcapng::Frame const& g = **y;
        std::string const& f_name = first->interfaces()[f.interface].name;
        std::string const& g_name = second->interfaces()[g.interface].name;
        if (f_name != g_name || f.time_ns != g.time_ns) {
            return differ(*first, f,
                          fmt::format("sent on {} at {} ns and on {} at {} ns", f_name, f.time_ns, g_name, g.time_ns));
        }
        if (f.octets != g.octets) {
            auto const at = std::mismatch(f.octets.begin(), f.octets.end(), g.octets.begin(), g.octets.end()).first -
                            f.octets.begin();
            return differ(*first, f, fmt::format("the octets differ from number {} on", at));
        }
        ++equal;
    }
}

} // namespace gridspace
