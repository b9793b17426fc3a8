// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/box.hpp"

#include "timebox/box_impl.hpp"
#include "timebox/start.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <sys/wait.h>

namespace gridspace::timebox {

Box::Impl::Impl(BoxOptions o, Started started, UniqueFd ours)
    : options{std::move(o)}, numbers{std::move(started.numbers)}, main{started.program}, door{started.door},
      table{options, report} {
    report.own_process_numbers = numbers.keeper > 0;
    report.notified = !started.listeners.empty();
    for (UniqueFd& listener : started.listeners) {
        stops.listen(std::move(listener));
    }
    ::sched_getaffinity(0, sizeof allowed, &allowed);
    for (pid_t const first : {main, door}) {
        if (first > 0) {
            add(first, first);
            begin_image(first);
        }
    }
    if (options.door) {
        channel.emplace(std::move(ours), options.door->take);
    }
}

Box::Impl::~Impl() {
    for (Thread const& t : threads) {
        ::kill(t.process, SIGKILL);
    }
    numbers.end();
    for (int status = 0; ::waitpid(-1, &status, __WALL) > 0 || errno == EINTR;) {
    }
}

Result<Box::Pause> Box::Impl::run_until(std::optional<std::int64_t> limit) {
    limit_ns = limit;
    since_limit.restart();
    if (options.link) { // between two ticks it may be moved
        share_a_processor();
    }
    while (main_alive && !error && !stop) {
        Thread* const next = choose();
        if (next == nullptr) {
            break;
        }
        let_go(*next);
    }
    leave_processor();
    if (!main_alive) {
        run_network();
    }
    if (error) {
        return std::unexpected{*error};
    }
    return stop ? Pause::stopped : main_alive ? Pause::limit : Pause::ended;
}

void Box::Impl::share_a_processor() {
    int const here = ::sched_getcpu();
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(std::max(here, 0)), &one);
    if (here < 0 || ::sched_setaffinity(0, sizeof one, &one) != 0) {
        return;
    }
    if (std::exchange(processor, here) != here) {
        for (Thread const& t : threads) { // those that they make inherit it
            ::sched_setaffinity(t.tid, sizeof one, &one);
        }
    }
}

void Box::Impl::roam() {
    if (options.link || processor < 0) {
        return;
    }
    leave_processor();
    for (Thread const& t : threads) {
        ::sched_setaffinity(t.tid, sizeof allowed, &allowed);
    }
    processor = -1;
    until_settled = kRoaming;
}

void Box::Impl::settle() {
    if (!options.link && until_settled > 0 && --until_settled == 0) {
        share_a_processor();
    }
}

void Box::Impl::leave_processor() const {
    if (processor >= 0) {
        ::sched_setaffinity(0, sizeof allowed, &allowed);
    }
}

Box::Box(std::unique_ptr<Impl> impl) : impl_{std::move(impl)} {}
Box::~Box() = default;

Result<std::unique_ptr<Box>> Box::start(BoxOptions options) {
    DoorEnds ends = options.door ? make_door_ends() : DoorEnds{};
    StartOptions start;
    start.command = options.command;
    start.environment = options.environment;
    start.detached = options.link.has_value();
    if (options.door) {
        start.door = options.door->command;
        start.door_fd = ends.theirs.get();
    }
    auto started = start_traced(start);
    if (!started) {
        return std::unexpected{started.error()};
    }
    return std::unique_ptr<Box>{
        new Box{std::make_unique<Impl>(std::move(options), std::move(*started), std::move(ends.ours))}};
}

Result<Box::Pause> Box::run_until(std::optional<std::int64_t> limit_ns) {
    return impl_->run_until(limit_ns);
}

std::optional<std::int64_t> Box::next_ns() const {
    return impl_->next_ns();
}

void Box::arrives(std::int64_t at_ns, std::span<std::byte const> frame) {
    auto const* const octets = reinterpret_cast<std::uint8_t const*>(frame.data());
    if (IpSockets* const ip = impl_->table.ip()) {
        ip->arrives(at_ns, {octets, frame.size()});
    }
    // Nobody takes what comes for a program that has ended.
    if (PacketSockets* const packets = impl_->table.packets(); packets != nullptr && impl_->main_alive) {
        packets->arrives(packet_frame(at_ns, {octets, octets + frame.size()}, packets->link().mac, false));
    }
}

void Box::hand(std::int64_t at_ns, std::vector<std::byte> message) {
    if (impl_->channel && impl_->main_alive) {
        impl_->channel->hand(at_ns, std::move(message));
    }
}

void Box::ask_to_end() {
    ::kill(impl_->main, SIGTERM);
    impl_->table.signalled().insert(impl_->main);
}

bool Box::can_look_inside() const {
    std::uint64_t word = 0;
    return read_memory(impl_->main, stack_of(impl_->main), &word, sizeof word) &&
           impl_->table.descriptors(impl_->main).copy_of(STDOUT_FILENO);
}

BoxReport Box::report() const {
    BoxReport out = impl_->report;
    out.simulated_ns = impl_->ended_ns.value_or(impl_->table.clock().now_ns());
    out.threads = impl_->threads_made;
    for (auto const& [call, times] : impl_->table.calls()) {
        out.calls[call->name] = times;
    }
    std::erase_if(out.refused, [](auto const& entry) { return entry.second == 0; });
    return out;
}

Result<BoxReport> try_here() {
    BoxOptions options;
    options.command = {"/proc/self/exe"}; // it does not get to its first instruction
    auto const box = Box::start(options);
    if (!box) {
        return std::unexpected{box.error()};
    }
    if (!box.value()->can_look_inside()) {
        return fail(ExitCode::environment, "a program's memory and descriptors cannot be looked at",
                    "process_vm_readv and pidfd_getfd must be allowed: in a container --cap-add SYS_PTRACE");
    }
    return box.value()->report();
}

} // namespace gridspace::timebox
