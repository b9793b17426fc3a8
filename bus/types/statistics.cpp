// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/types/codec_impl.hpp"

#include <statisticsPubSubTypes.h>

GRIDSPACE_CODEC(StreamStatistics)
