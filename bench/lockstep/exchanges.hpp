// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace gridspace::bench {

/// One way to exchange a step: 1 KiB from the simulator to each of N member processes, 32 octets back from each.
/// `member` is the index of this process among the members, or -1 in the simulator. Returns the microseconds of each
/// step (simulator only).
using Exchange = std::vector<double> (*)(int member, int members, std::uint64_t steps, int domain);

std::vector<double> exchange_contract(int member, int members, std::uint64_t steps,
                                      int domain); ///< clock, ledger, barrier
std::vector<double> exchange_bare_dds(int member, int members, std::uint64_t steps, int domain); ///< Fast DDS ping-pong
std::vector<double> exchange_bare_udp(int member, int members, std::uint64_t steps, int domain); ///< sockets alone

} // namespace gridspace::bench
