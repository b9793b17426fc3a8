// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/lockstep/wire_book.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::lockstep {
namespace {

constexpr std::size_t kMaxOwnSources = 256;

} // namespace

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

WireBook::WireBook(std::size_t processes, std::vector<Channel> const& channels, std::size_t max_unannounced)
    : max_unannounced_{max_unannounced}, incarnations_(processes, 0), awaited_of_(processes, 0) {
    for (Channel const& channel : channels) {
        channels_.push_back({channel, {}, {}, {}, {}});
        channels_.back().awaited.reserve(max_unannounced);
        channels_.back().early.reserve(max_unannounced + 1);
        channels_.back().own_sources.reserve(kMaxOwnSources);
    }
}

std::size_t WireBook::channel_index(std::string_view link, std::uint16_t ethertype) const {
    for (std::size_t i = 0; i < channels_.size(); ++i) {
        if (channels_[i].channel.ethertype == ethertype && channels_[i].channel.link == link) {
            return i;
        }
    }
    return kUnknown;
}

bool WireBook::enter_incarnation(std::size_t process, std::uint32_t incarnation) {
    if (incarnation < incarnations_[process]) {
        return false;
    }
    if (incarnation > incarnations_[process]) {
        incarnations_[process] = incarnation; // what the old one announced and did not send will not come
        awaited_of_[process] = 0;
        for (State& state : channels_) {
            std::erase_if(state.awaited, [&](Awaited const& a) { return a.process == process; });
        }
    }
    return true;
}

FrameBuffer WireBook::take_early(std::size_t channel, std::uint64_t identity) {
    State& state = channels_[channel];
    auto const it =
        std::find_if(state.early.begin(), state.early.end(), [&](Early const& e) { return e.identity == identity; });
    if (it == state.early.end()) {
        return nullptr;
    }
    FrameBuffer frame = std::move(it->frame);
    state.early.erase(it);
    remember_source(state, *frame);
    return frame;
}

void WireBook::remember_source(State& state, WireFrame const& frame) {
    if (!is_own(state, frame) && state.own_sources.size() < kMaxOwnSources) {
        state.own_sources.push_back(source_of(frame.octets));
    }
}

bool WireBook::is_own(State const& state, WireFrame const& frame) {
    std::uint64_t const source = source_of(frame.octets);
    return source >> 24U == kRunAddressPrefix ||
           std::find(state.own_sources.begin(), state.own_sources.end(), source) != state.own_sources.end();
}

WireBook::Arrival WireBook::arrived(std::size_t channel, FrameBuffer frame) {
    State& state = channels_[channel];
    std::uint64_t const identity = frame_identity(frame->octets);
    auto const it = std::find_if(state.awaited.begin(), state.awaited.end(),
                                 [&](Awaited const& a) { return a.record.identity == identity; });
    if (it != state.awaited.end()) {
        --awaited_of_[it->process];
        Arrival arrival{std::move(frame), it->record.send_time_ns, nullptr};
        state.awaited.erase(it);
        remember_source(state, *arrival.due);
        return arrival;
    }
    state.early.push_back({identity, std::move(frame)});
    Arrival arrival;
    if (state.early.size() > max_unannounced_) {
        // A flood displaces itself, and not a frame of the run whose ledger is still on its way.
        auto victim = std::find_if(state.early.begin(), state.early.end(),
                                   [&](Early const& e) { return !is_own(state, *e.frame); });
        victim = victim == state.early.end() ? state.early.begin() : victim;
        state.evicted.add(source_of(victim->frame->octets));
        arrival.evicted = std::move(victim->frame);
        state.early.erase(victim);
    }
    return arrival;
}

std::string WireBook::missing(std::size_t process) const {
    std::string out;
    for (State const& state : channels_) {
        auto const count = std::count_if(state.awaited.begin(), state.awaited.end(),
                                         [&](Awaited const& a) { return a.process == process; });
        if (count > 0) {
            out += fmt::format("{}{} frame(s) of ethertype {:#06x} on '{}'", out.empty() ? "" : ", ", count,
                               state.channel.ethertype, state.channel.link);
        }
    }
    return out;
}

ForeignFrames WireBook::foreign(std::size_t channel) const {
    ForeignFrames out = channels_[channel].evicted;
    for (Early const& early : channels_[channel].early) {
        out.add(source_of(early.frame->octets));
    }
    return out;
}

} // namespace gridspace::lockstep
