// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// One libFuzzer program for all targets: `gridspace-fuzz TARGET [libFuzzer's arguments]`; without a name it prints
// them.
#include "targets.hpp"

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace {
void (*target)(std::uint8_t const*, std::size_t) = nullptr;
} // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
    std::string_view const wanted = *count > 1 ? (*arguments)[1] : "";
    for (auto const& known : gridspace::fuzz::kTargets) {
        if (wanted.empty()) {
            std::puts(known.name);
        } else if (wanted == known.name) {
            target = known.run;
        }
    }
    if (target == nullptr) {
        std::exit(wanted.empty() ? 0 : 2);
    }
    (*arguments)[1] = (*arguments)[0];
    ++*arguments;
    --*count;
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
    target(data, size);
    return 0;
}
