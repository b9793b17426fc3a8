// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/lockstep/foreign_frames.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::lockstep {

std::uint64_t source_of(std::span<std::byte const> frame) {
    constexpr std::size_t kSource = 6, kAddress = 6;
    std::uint64_t out = 0;
    for (std::size_t i = kSource; frame.size() >= kSource + kAddress && i < kSource + kAddress; ++i) {
        out = (out << 8U) | static_cast<std::uint64_t>(frame[i]);
    }
    return out;
}

void ForeignFrames::add(std::uint64_t source) {
    auto const it = std::find_if(named_.begin(), named_.end(), [&](Source const& s) { return s.address == source; });
    if (it != named_.end()) {
        ++it->frames;
    } else if (named_.size() < kNamed) {
        named_.reserve(kNamed);
        named_.push_back({source, 1});
    } else {
        ++unnamed_;
    }
}

std::uint64_t ForeignFrames::total() const {
    std::uint64_t out = unnamed_;
    for (Source const& source : named_) {
        out += source.frames;
    }
    return out;
}

std::string ForeignFrames::text() const {
    std::vector<Source> sorted = named_;
    std::sort(sorted.begin(), sorted.end(), [](Source const& a, Source const& b) {
        return a.frames != b.frames ? a.frames > b.frames : a.address < b.address;
    });
    std::string out;
    for (Source const& source : sorted) {
        out += fmt::format("{}{} from", out.empty() ? "" : ", ", source.frames);
        for (int shift = 40; shift >= 0; shift -= 8) {
            out += fmt::format("{}{:02x}", shift == 40 ? ' ' : ':', (source.address >> shift) & 0xffU);
        }
    }
    return unnamed_ == 0 ? out : out + fmt::format(", {} from others", unnamed_);
}

} // namespace gridspace::lockstep
