// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What a process takes from the bus: samples of the types that it was compiled for.
#include "bus/codec.hpp"
#include "targets.hpp"

#include <algorithm>
#include <bus_gateway.h>
#include <catalog.h>
#include <clock.h>
#include <ev_charging.h>
#include <intrusion.h>
#include <protection.h>
#include <signals.h>
#include <statistics.h>
#include <vector>

namespace gridspace::fuzz {
namespace {

template <class T>
std::vector<std::byte> encoded(bus::Codec const& codec, T const& sample) {
    std::vector<std::byte> out(codec.encoded_size(&sample));
    std::size_t const used = codec.encode(&sample, out);
    require(used > 0 && used <= out.size(), "what was decoded cannot be encoded");
    out.resize(used);
    return out;
}

template <class T>
void try_as(std::span<std::byte const> octets) {
    bus::Codec const& codec = bus::codec_of<T>();
    T sample;
    if (!codec.decode(octets, &sample)) {
        return;
    }
    std::array<std::uint8_t, 16> key{};
    codec.key(&sample, key);
    auto const once = encoded(codec, sample);
    T again;
    require(codec.decode(once, &again) && encoded(codec, again) == once, "a sample changed");
}

template <class... T>
void try_all(std::span<std::byte const> octets) {
    (try_as<T>(octets), ...);
}

} // namespace

void sample(std::uint8_t const* data, std::size_t size) {
    try_all<SimClock, ClockAck, MemberStatus, BusMeasurement, ChargingRequest, ChargingDecision, LineCurrents,
            TripCommand, BreakerStatus, SignalCatalog, SignalFrame, TypeCatalogEntry, IdsVerdict, AttackLabel,
            StreamStatistics>(std::as_bytes(std::span{data, size}));
}

} // namespace gridspace::fuzz
