// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/types/codec_impl.hpp"

#include <ev_chargingPubSubTypes.h>

GRIDSPACE_CODEC(ChargingRequest)
GRIDSPACE_CODEC(ChargingDecision)
