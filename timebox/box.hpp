// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "timebox/door_channel.hpp"
#include "timebox/packet_link.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::timebox {

struct BoxOptions {
    std::vector<std::string> command; ///< searched for in PATH
    std::uint64_t seed{1};            ///< of every random number that the kernel would give
    std::int64_t epoch_unix_s{0};     ///< what CLOCK_REALTIME shows at simulated time 0
    std::int64_t begin_ns{0};         ///< simulated time at which it starts
    double patience_s{60};            ///< of real time, that a program may compute without a call; 0: without end
    double rest_s{0};                 ///< of real time, until all that was due is done; 0: without end
    /// A call that was held: simulated time at which it goes on, s; number of the thread; name; how long, simulated, s.
    std::function<void(double, int, char const*, double)> on_held;
    /// The only network that it has: its packet sockets are served from here. Without one they are the kernel's, and
    /// what comes from outside comes when it comes.
    std::optional<PacketLink> link;
    std::optional<DoorOptions> door;                                ///< a program of ours next to it
    std::vector<std::pair<std::string, std::string>> environment{}; ///< where it is not set otherwise
    bool looks_in_program{true}; ///< looks at the clock are answered there, as long as it makes no difference
    /// Looked at some times per second: it shall end.
    std::function<bool()> stop;
};

struct BoxReport {
    int exit_code{0}; ///< as a shell has it: 128 + n after signal n
    std::int64_t simulated_ns{0};
    std::uint64_t held{0}, clock_reads{0};
    int threads{0};
    bool own_process_numbers{false};              ///< the same in each run; otherwise the machine's
    bool notified{false};                         ///< of its calls by seccomp; otherwise all stop under ptrace
    std::map<std::string, std::uint64_t> calls;   ///< that stopped, by name
    std::map<std::string, std::uint64_t> refused; ///< what cannot be had in simulated time, and how often it was tried
    /// What was let through, and does not belong to simulated time.
    std::map<std::string, std::uint64_t> not_simulated;
    std::string last_call; ///< of the first process, or of who computes without end
};

/// A program, and all that it starts, in simulated time: its clocks stand still while it computes, and jump to the next
/// deadline when all of its threads wait. One thread runs at a time, in an order that does not depend on the machine.
/// One box in a process, used by one thread: the one that made it.
class Box {
  public:
    [[nodiscard]] static Result<std::unique_ptr<Box>> start(BoxOptions options);
    ~Box(); ///< ends all that still runs
    Box(Box const&) = delete;
    Box& operator=(Box const&) = delete;

    enum class Pause {
        limit, ///< nothing is left to do up to the limit
        ended, ///< the program has ended
        stopped,
    };
    /// Lets it run until nothing is left to do up to and including `limit_ns`; without a limit, until it ends. Errors:
    /// it computes without end; all wait for each other, and nothing can come from outside. When it has ended, what is
    /// left of its host (its end of connections) goes on up to the limit.
    [[nodiscard]] Result<Pause> run_until(std::optional<std::int64_t> limit_ns);

    /// When it wants to go on by itself. Nothing: it waits for frames.
    [[nodiscard]] std::optional<std::int64_t> next_ns() const;
    /// A frame, with its VLAN tag, that its interface receives at that time; in their order.
    void arrives(std::int64_t at_ns, std::span<std::byte const> frame);
    /// A message for the door, which is there at that time; in their order.
    void hand(std::int64_t at_ns, std::vector<std::byte> message);
    void ask_to_end();                          ///< SIGTERM to the program
    [[nodiscard]] bool can_look_inside() const; ///< at the program's memory and descriptors
    [[nodiscard]] BoxReport report() const;

  private:
    struct Impl;
    explicit Box(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Whether programs can run in simulated time on this machine, and how: own_process_numbers, notified. Tries it.
[[nodiscard]] Result<BoxReport> try_here();

} // namespace gridspace::timebox
