// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/machine.hpp"

#include <fstream>

namespace gridspace::bus {

std::string const& this_machine() {
    static std::string const name = [] {
        std::string id;
        std::ifstream{"/proc/sys/kernel/random/boot_id"} >> id; // random(4)
        return id.substr(0, 13);
    }();
    return name;
}

} // namespace gridspace::bus
