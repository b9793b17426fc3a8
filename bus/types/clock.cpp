// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/types/codec_impl.hpp"

#include <clockPubSubTypes.h>

GRIDSPACE_CODEC(SimClock)
GRIDSPACE_CODEC(ClockAck)
GRIDSPACE_CODEC(MemberStatus)
