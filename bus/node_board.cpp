// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A node on the shared memory of the clock, where all members are on this machine.
#include "bus/node_core.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <span>
#include <thread>

namespace gridspace::bus {

Result<void> Node::Core::join_board() {
    char const* const descriptor = std::getenv("GRIDSPACE_BOARD");
    if (!lockstep() || descriptor == nullptr) {
        return {};
    }
    std::vector<std::string> processes = config.clock.members;
    processes.push_back(config.clock.simulator);
    int number = -1; // no number: Board::join says that it is none of ours
    std::from_chars(descriptor, descriptor + std::strlen(descriptor), number);
    auto joined = Board::join(UniqueFd{number}, std::move(processes), config.process);
    if (!joined) {
        return std::unexpected{joined.error()};
    }
    board = std::move(*joined);
    ::unsetenv("GRIDSPACE_BOARD"); // not for programs that this one starts
    for (std::string const& name : is_simulator() ? config.clock.members : config.clock.upstream) {
        board_heard.push_back(board->place_of(name));
    }
    for (std::string const& name : config.clock.downstream) {
        auto const& late = config.clock.late_downstream;
        if (std::find(late.begin(), late.end(), name) != late.end()) {
            continue; // the next clock wakes it
        }
        board_rung.push_back(board->place_of(name));
    }
    board_simulator = board->place_of(config.clock.simulator);
    if (!is_simulator()) {
        board_heard.push_back(board_simulator);
        board_rung.push_back(board_simulator);
    }
    return {};
}

bool Node::Core::take_board() {
    static thread_local ClockAck received; // keeps its capacity
    bool any = false;
    std::size_t place = 0;
    auto const take = [&](Board::Message const& message) {
        any = true;
        SampleHeader header;
        header.sequence = message.number;
        header.source_ns = message.time_ns;
        std::lock_guard const lock{mutex};
        if (place == board_simulator) {
            if (codec_of<SimClock>().decode(message.octets, &clock)) {
                take_clock(message.octets, header);
            }
        } else if (codec_of<ClockAck>().decode(message.octets, &received)) {
            take_ack(message.octets, header, book->process_index(received.member().c_str()), received);
        }
    };
    for (std::size_t const heard : board_heard) {
        place = heard;
        if (!board->read(place, std::ref(take))) { // by reference: no memory is asked for
            fail({ExitCode::stall, "more was said on the shared memory of the clock than it keeps",
                  "clock: {shared_memory: false} goes without"});
            return true;
        }
    }
    return any;
}

template <class T>
bool Node::Core::post(T const& message, std::int64_t time_ns, std::uint64_t number) {
    Codec const& codec = codec_of<T>();
    posted.assign(codec.encoded_size(&message), std::byte{0}); // the CDR library skips padding octets
    std::size_t const used = codec.encode(&message, posted);
    return used > 0 && board->post(std::span{posted}.first(used), time_ns, number);
}
template bool Node::Core::post(SimClock const& message, std::int64_t time_ns, std::uint64_t number);
template bool Node::Core::post(ClockAck const& message, std::int64_t time_ns, std::uint64_t number);

bool Node::Core::show_to_others(bool always) {
    constexpr std::chrono::milliseconds kOften{50};
    auto const now = std::chrono::steady_clock::now();
    if (board != nullptr && !always && now - shown_at < kOften) {
        return false;
    }
    shown_at = now;
    return true;
}

void Node::Core::wait_for_more(Receiving::Turn& turn, std::unique_lock<std::mutex>& lock,
                               std::chrono::nanoseconds longest, bool samples_only) {
    if (board == nullptr) {
        turn.wait(lock, changed, longest);
        return;
    }
    constexpr std::chrono::milliseconds kLook{20};        // at what comes over the network
    constexpr std::chrono::microseconds kOnTheirWay{200}; // samples that were sent before the acknowledgements
    worker = std::this_thread::get_id();
    std::uint32_t const heard = board->bell();
    lock.unlock();
    bool any = take_board();
    lock.lock();
    auto const is_time_to_look = [&] { // of who is not asked, the sockets would fill up while others talk
        auto const now = std::chrono::steady_clock::now();
        bool const is_time = now - looked_at >= kLook;
        looked_at = is_time ? now : looked_at;
        return is_time;
    };
    if (any) {
        if (is_time_to_look()) {
            turn.wait(lock, changed, std::chrono::nanoseconds{0});
        }
        return;
    }
    if (samples_only) {
        turn.wait(lock, changed, kOnTheirWay);
        return;
    }
    lock.unlock();
    board->wait(heard, std::min<std::chrono::nanoseconds>(longest, kLook));
    any = take_board();
    lock.lock();
    if (!any || is_time_to_look()) {
        turn.wait(lock, changed, std::chrono::nanoseconds{0});
    }
}

} // namespace gridspace::bus
