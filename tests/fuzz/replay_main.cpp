// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Runs a fuzz function on the files that are given, or on all files of a folder: the corpus as a unit test, without
// libFuzzer.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size);

int main(int argc, char** argv) {
    int count = 0;
    auto const replay = [&](std::filesystem::path const& file) {
        std::ifstream stream{file, std::ios::binary};
        std::string const text{std::istreambuf_iterator<char>{stream}, {}};
        LLVMFuzzerTestOneInput(reinterpret_cast<std::uint8_t const*>(text.data()), text.size());
        ++count;
    };
    for (int i = 1; i < argc; ++i) {
        if (std::filesystem::is_directory(argv[i])) {
            for (auto const& entry : std::filesystem::directory_iterator{argv[i]}) {
                replay(entry.path());
            }
        } else {
            replay(argv[i]);
        }
    }
    std::printf("%d inputs\n", count);
    return count > 0 ? 0 : 1; // a corpus that is not found must not pass
}
