// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/privileges/capabilities.hpp"

#include <array>
#include <cstddef>
#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace gridspace {

void keep_only_capabilities(std::uint64_t capabilities) noexcept {
    for (unsigned bit = 0; ::prctl(PR_CAPBSET_READ, bit, 0, 0, 0) >= 0; ++bit) {
        if ((capabilities >> bit & 1U) == 0) {
            ::prctl(PR_CAPBSET_DROP, bit, 0, 0, 0);
        }
    }
    __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
    std::array<__user_cap_data_struct, 2> sets{};
    if (::syscall(SYS_capget, &header, sets.data()) == 0) {
        for (std::size_t word = 0; word < sets.size(); ++word) {
            auto const kept = static_cast<std::uint32_t>(capabilities >> (32 * word));
            sets[word].permitted &= kept;
            sets[word].effective = sets[word].permitted;
            sets[word].inheritable = 0;
        }
        ::syscall(SYS_capset, &header, sets.data());
    }
    ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
}

bool may_open_raw_sockets() noexcept {
    __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
    std::array<__user_cap_data_struct, 2> sets{};
    return ::syscall(SYS_capget, &header, sets.data()) == 0 && (sets[0].effective & kMayOpenRawSockets) != 0;
}

} // namespace gridspace
