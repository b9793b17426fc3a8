// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace gridspace::ids {

/// Runs `work(chunk)` for chunks 0 .. count-1 on so many threads. Which thread takes which chunk is chance, so a chunk
/// may only write to its own place, and results are put together in the order of chunks.
inline void for_each_chunk(std::size_t count, int threads, std::function<void(std::size_t)> const& work) {
    std::atomic<std::size_t> next{0};
    auto const run = [&] {
        for (std::size_t k = next++; k < count; k = next++) {
            work(k);
        }
    };
    std::vector<std::jthread> others;
    for (int t = 1; t < threads; ++t) {
        others.emplace_back(run);
    }
    run();
}

} // namespace gridspace::ids
