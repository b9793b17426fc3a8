// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/rtps_guard/octets.hpp"

namespace gridspace::rtps_guard {

/// What anybody may send to a participant of a secured bus before he has shown who he is (DDS Security 1.1, 7.2 and
/// 7.4.4). Fast DDS 2.9 makes room for as many properties as a number in them says, before it looks whether they are
/// there.

/// Takes a DataHolder: a class, properties (two strings each) and binary properties (a string and octets each). False
/// when its numbers do not fit into the octets that are there.
[[nodiscard]] bool take_data_holder(Octets& octets);

/// The payload of a ParticipantGenericMessage, its encapsulation included: who speaks to whom, and data holders.
[[nodiscard]] bool is_generic_message(Octets payload);

} // namespace gridspace::rtps_guard
