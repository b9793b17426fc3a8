// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Steps per second of the lockstep contract, with clock and acknowledgements over the shared memory that `gridspace
// run` gives to members on one machine and with all of it over DDS, compared with a bare Fast DDS ping-pong and a UDP
// one, of the same shape, in one run. What the members say is on DDS each time. Each member is a process. Usage:
// bench_lockstep [members ...] [--steps N] [--rounds R]
#include "bench/lockstep/exchanges.hpp"
#include "bus/board/board.hpp"
#include "common/realtime.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numeric>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace {

using gridspace::bench::Exchange;

struct Figures {
    double steps_per_s{0};
    double p50_us{0};
    double p99_us{0};
};

/// Runs one exchange: members and simulator are children, so that nothing of DDS stays behind in this process.
Figures measure(Exchange exchange, int members, std::uint64_t steps, int domain, bool shares_memory = false) {
    gridspace::UniqueFd board;
    if (shares_memory) {
        auto memory = gridspace::bus::Board::create(static_cast<std::size_t>(members) + 1);
        if (!memory) {
            std::fprintf(stderr, "%s\n", describe(memory.error()).c_str());
            std::exit(3);
        }
        board = std::move(*memory);
    }
    int pipe_ends[2];
    if (::pipe(pipe_ends) != 0) {
        std::perror("pipe");
        std::exit(3);
    }
    std::vector<pid_t> children;
    for (int member = -1; member < members; ++member) {
        pid_t const pid = ::fork();
        if (pid == 0) {
            ::close(pipe_ends[0]);
            if (board) {
                ::setenv("GRIDSPACE_BOARD", std::to_string(board.get()).c_str(), 1);
            }
            std::vector<double> times = exchange(member, members, steps, domain);
            if (member < 0) {
                Figures figures;
                figures.steps_per_s =
                    1e6 * static_cast<double>(times.size()) / std::accumulate(times.begin(), times.end(), 0.0);
                std::sort(times.begin(), times.end());
                figures.p50_us = times[times.size() / 2];
                figures.p99_us = times[times.size() * 99 / 100];
                if (::write(pipe_ends[1], &figures, sizeof figures) != sizeof figures) {
                    std::_Exit(1);
                }
            }
            std::_Exit(0);
        }
        children.push_back(pid);
    }
    ::close(pipe_ends[1]);
    Figures figures;
    if (::read(pipe_ends[0], &figures, sizeof figures) != sizeof figures) {
        std::fprintf(stderr, "the simulator of the benchmark failed\n");
        std::exit(1);
    }
    ::close(pipe_ends[0]);
    for (pid_t const pid : children) {
        ::waitpid(pid, nullptr, 0);
    }
    return figures;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

} // namespace

int main(int argc, char** argv) {
    auto const awake = gridspace::keep_processors_awake(); // as in a run, and for all that is compared with it
    std::vector<int> counts;
    std::uint64_t steps = 3000;
    int rounds = 3;
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--steps") == 0 && i + 1 < argc) {
            steps = std::strtoull(argv[++i], nullptr, 10);
        } else if (std::strcmp(argv[i], "--rounds") == 0 && i + 1 < argc) {
            rounds = std::atoi(argv[++i]);
        } else {
            counts.push_back(std::atoi(argv[i]));
        }
    }
    if (counts.empty()) {
        counts = {1, 4, 16, 50};
    }
    std::printf(
        "members  as `run` starts it, steps/s (p50/p99 us)  all over DDS, steps/s  bare DDS, steps/s  bare UDP, "
        "steps/s  ratios to bare DDS\n");
    int domain = 40;
    for (int const members : counts) {
        std::vector<double> shared, contract, dds, udp, shared_ratio, ratio;
        Figures b, c, d, u;
        std::uint64_t const n =
            std::max<std::uint64_t>(200, steps / static_cast<std::uint64_t>(std::max(1, members / 4)));
        for (int r = 0; r < rounds; ++r) {
            domain = 40 + (domain - 39) % 50;
            b = measure(gridspace::bench::exchange_contract, members, n, domain, true);
            c = measure(gridspace::bench::exchange_contract, members, n, domain);
            d = measure(gridspace::bench::exchange_bare_dds, members, n, domain);
            u = measure(gridspace::bench::exchange_bare_udp, members, n, domain);
            shared.push_back(b.steps_per_s);
            contract.push_back(c.steps_per_s);
            dds.push_back(d.steps_per_s);
            udp.push_back(u.steps_per_s);
            shared_ratio.push_back(b.steps_per_s / d.steps_per_s);
            ratio.push_back(c.steps_per_s / d.steps_per_s);
        }
        std::printf("%7d  %9.0f (%.0f/%.0f)  %9.0f (%.0f/%.0f)  %9.0f (%.0f/%.0f)  %9.0f (%.0f/%.0f)  %.2f  %.2f\n",
                    members, median(shared), b.p50_us, b.p99_us, median(contract), c.p50_us, c.p99_us, median(dds),
                    d.p50_us, d.p99_us, median(udp), u.p50_us, u.p99_us, median(shared_ratio), median(ratio));
        std::fflush(stdout);
    }
    return 0;
}
