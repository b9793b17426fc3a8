// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/codec_impl.hpp"

#include <bench_exchangePubSubTypes.h>

GRIDSPACE_CODEC(StepOutput)
GRIDSPACE_CODEC(StepReply)
