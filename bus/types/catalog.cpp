// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/types/codec_impl.hpp"

#include <catalogPubSubTypes.h>

GRIDSPACE_CODEC(TypeCatalogEntry)
