// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/random.hpp"
#include "timebox/box.hpp"
#include "timebox/futexes.hpp"
#include "timebox/ip_calls.hpp"
#include "timebox/packet_calls.hpp"
#include "timebox/simulated_clock.hpp"
#include "timebox/thread.hpp"
#include "timebox/timers.hpp"

#include <map>
#include <set>
#include <sys/socket.h>

namespace gridspace::timebox {

/// What socket(2) and accept4(2) take in addition to the kind.
inline constexpr std::uint64_t kSocketFlags = SOCK_CLOEXEC | SOCK_NONBLOCK;

/// What each call means in simulated time. The threads stand still while it looks at them.
class CallTable {
  public:
    CallTable(BoxOptions const& options, BoxReport& report);

    /// How the thread goes on.
    enum class Next {
        go,            ///< the call is answered, or runs as it is
        go_to_exit,    ///< it runs, and leave() wants to see it come back
        hold,          ///< it waits
        let_others_go, ///< answered; but others come first
        answered,      ///< of release(): it has its answer, and others may come first
    };
    /// The thread is about to make a call.
    Next enter(Thread& t);
    /// The call has come back: `hold` when it has to be made again, later.
    Next leave(Thread& t);
    /// What the thread waits for is there, or its time is over.
    Next release(Thread& t);

    /// Without a look at its descriptors.
    [[nodiscard]] bool may_go(Thread const& t) const;
    [[nodiscard]] bool descriptors_ready(Thread const& t);
    /// A signal that it does not block waits for it.
    [[nodiscard]] bool has_signal(Thread const& t) const;

    [[nodiscard]] SimulatedClock& clock() { return clock_; }
    [[nodiscard]] Timers& timers() { return timers_; }
    [[nodiscard]] Futexes& futexes() { return futexes_; }
    [[nodiscard]] std::set<pid_t>& signalled() { return signalled_; } ///< processes that a signal may have come to
    [[nodiscard]] Descriptors const& descriptors(pid_t process);
    [[nodiscard]] std::map<HeldCall const*, std::uint64_t> const& calls() const { return calls_; } ///< that stopped
    [[nodiscard]] PacketSockets* packets() { return packets_ ? &*packets_ : nullptr; }
    [[nodiscard]] IpSockets* ip() { return ip_ ? &*ip_ : nullptr; }
    /// Looks at the clock that the program has answered itself: clock_gettime, gettimeofday, time.
    void count_looks(std::array<std::int64_t, 3> const& looks);
    void forget(pid_t process);       ///< it has ended
    void forget_image(pid_t process); ///< it is another program now: its alarm stays
    [[nodiscard]] std::array<std::uint8_t, 16> random_octets();

  private:
    Next answer_clock(Thread& t);
    void look_again();
    Next hold_until(Thread& t, std::optional<std::int64_t> deadline_ns);
    Next sleep(Thread& t);
    void tell_rest_of_sleep(Thread const& t);
    Next look_at_descriptors(Thread& t);
    Next transfer(Thread& t, short event);
    [[nodiscard]] std::vector<std::uint8_t> draw(std::size_t octets); ///< at most a mebioctet
    Next get_random(Thread const& t);
    /// False: that is not what it reads.
    bool read_random(Thread const& t, UniqueFd const& file);
    Next futex(Thread& t);
    Next wait_for_child(Thread& t);
    Next timer(Thread& t);
    Next option(Thread& t);
    void remember_receive_timeout(Thread const& t);
    /// As it was asked for: what the kernel returns is rounded to its ticks, which differ from machine to machine.
    [[nodiscard]] std::optional<std::int64_t> exact_receive_timeout_ns(UniqueFd const& file) const;
    Next packet(Thread& t);
    Next new_socket(Thread& t);
    Next map_memory(Thread& t);
    Next packet_transfer(Thread& t, PacketSocket& socket, UniqueFd const& file, short event, bool waits);
    /// The packet socket that an argument of its call names.
    struct Named {
        UniqueFd file;
        PacketSocket* socket{nullptr};
    };
    [[nodiscard]] Named packet_socket_of(Thread const& t, std::size_t argument = 0);
    Next new_ip_socket(Thread& t);
    std::optional<Next> ip_call(Thread& t); ///< nothing: it is not about an IP socket
    Next ip_transfer(Thread& t, IpSocket& socket, UniqueFd const& file, short event, bool waits);
    Next ip_release(Thread& t, IpSocket& socket, UniqueFd const& file, bool over);
    Next take_connection(Thread& t);
    void ip_leave(Thread& t, Thread::OnExit done, std::int64_t result);
    struct NamedIp {
        UniqueFd file;
        IpSocket* socket{nullptr};
    };
    [[nodiscard]] NamedIp ip_socket_of(Thread const& t);
    Next refuse(Thread& t, std::string const& what, int error);

    SimulatedClock clock_;
    Timers timers_;
    Futexes futexes_;
    Random random_;
    std::map<pid_t, Descriptors> descriptors_;
    std::set<pid_t> signalled_;
    std::map<std::uint64_t, std::int64_t> receive_timeouts_; ///< by inode of the socket
    std::map<HeldCall const*, std::uint64_t> calls_;
    std::optional<PacketSockets> packets_;
    std::optional<PacketCalls> packet_calls_;
    std::optional<IpSockets> ip_;
    std::optional<IpCalls> ip_calls_;
    BoxReport& report_;
};

} // namespace gridspace::timebox
