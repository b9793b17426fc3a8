// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/types/codec_impl.hpp"

#include <intrusionPubSubTypes.h>

GRIDSPACE_CODEC(IdsVerdict)
GRIDSPACE_CODEC(AttackLabel)
