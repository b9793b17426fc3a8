// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/codec.hpp"

#include <array>
#include <bus_gateway.h>
#include <catalog.h>
#include <clock.h>
#include <ev_charging.h>
#include <intrusion.h>
#include <protection.h>
#include <signals.h>
#include <statistics.h>

namespace gridspace::bus {

Codec const* find_codec(std::string_view type_name) {
    static std::array const kAll{
        &codec_of<SimClock>(),       &codec_of<ClockAck>(),        &codec_of<MemberStatus>(),
        &codec_of<BusMeasurement>(), &codec_of<ChargingRequest>(), &codec_of<ChargingDecision>(),
        &codec_of<LineCurrents>(),   &codec_of<TripCommand>(),     &codec_of<BreakerStatus>(),
        &codec_of<SignalCatalog>(),  &codec_of<SignalFrame>(),     &codec_of<TypeCatalogEntry>(),
        &codec_of<IdsVerdict>(),     &codec_of<AttackLabel>(),     &codec_of<StreamStatistics>(),
    };
    for (Codec const* codec : kAll) {
        if (codec->type_name == type_name) {
            return codec;
        }
    }
    return nullptr;
}

} // namespace gridspace::bus
