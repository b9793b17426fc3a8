// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/lockstep/wire_book.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::lockstep {

std::uint64_t frame_identity(std::span<std::byte const> frame) {
    constexpr std::size_t kAddresses = 12, kTag = 4;
    bool const tagged =
        frame.size() >= kAddresses + kTag && frame[12] == std::byte{0x81} && frame[13] == std::byte{0x00};
    std::uint64_t hash = 0xcbf29ce484222325;
    for (std::size_t i = 0; i < frame.size(); ++i) {
        if (tagged && i >= kAddresses && i < kAddresses + kTag) {
            continue;
        }
        hash = (hash ^ static_cast<std::uint64_t>(frame[i])) * 0x100000001b3;
    }
    return hash;
}

WireBook::WireBook(std::size_t processes, std::vector<Channel> channels)
    : channels_{std::move(channels)}, incarnations_(processes, 0) {
    awaited_.reserve(kMaxUnannounced);
    early_.reserve(kMaxUnannounced + 1);
}

std::size_t WireBook::channel_index(std::string_view link, std::uint16_t ethertype) const {
    for (std::size_t i = 0; i < channels_.size(); ++i) {
        if (channels_[i].ethertype == ethertype && channels_[i].link == link) {
            return i;
        }
    }
    return kUnknown;
}

void WireBook::enter_incarnation(std::size_t process, std::uint32_t incarnation) {
    if (incarnation > incarnations_[process]) {
        incarnations_[process] = incarnation; // what the old one announced and did not send will not come
        std::erase_if(awaited_, [&](Awaited const& a) { return a.process == process; });
    }
}

std::size_t WireBook::take_early(std::size_t channel, std::uint64_t identity) {
    auto const it = std::find_if(early_.begin(), early_.end(),
                                 [&](Early const& e) { return e.identity == identity && e.channel == channel; });
    if (it == early_.end()) {
        return kUnknown;
    }
    std::size_t const slot = it->slot;
    early_.erase(it);
    return slot;
}

WireBook::Arrival WireBook::arrived(std::size_t channel, std::uint64_t identity, std::size_t slot) {
    auto const it = std::find_if(awaited_.begin(), awaited_.end(), [&](Awaited const& a) {
        return a.record.identity == identity && a.channel == channel;
    });
    if (it != awaited_.end()) {
        Arrival const arrival{true, it->record.send_time_ns, kUnknown};
        awaited_.erase(it);
        return arrival;
    }
    Arrival arrival;
    if (early_.size() >= kMaxUnannounced) {
        arrival.evicted = early_.front().slot;
        early_.erase(early_.begin());
    }
    early_.push_back({channel, identity, slot});
    return arrival;
}

bool WireBook::complete(std::size_t process) const {
    return std::none_of(awaited_.begin(), awaited_.end(), [&](Awaited const& a) { return a.process == process; });
}

std::string WireBook::missing(std::size_t process) const {
    std::string out;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        auto const count = std::count_if(awaited_.begin(), awaited_.end(),
                                         [&](Awaited const& a) { return a.process == process && a.channel == c; });
        if (count > 0) {
            out += fmt::format("{}{} frame(s) of ethertype {:#06x} on '{}'", out.empty() ? "" : ", ", count,
                               channels_[c].ethertype, channels_[c].link);
        }
    }
    return out;
}

} // namespace gridspace::lockstep
