// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/types/codec_impl.hpp"

#include <protectionPubSubTypes.h>

GRIDSPACE_CODEC(LineCurrents)
GRIDSPACE_CODEC(TripCommand)
GRIDSPACE_CODEC(BreakerStatus)
