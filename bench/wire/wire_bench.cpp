// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Frames over a virtual cable in a namespace of its own: throughput of one send per call against batches, and round
// trips and those of bare sockets in the same run. Prints JSON; asserts nothing.
#include "gateways/ethernet/port.hpp"
#include "gateways/iec61850/sv_template.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fmt/format.h>
#include <sched.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

// The baseline is what anybody would write without us, so it needs what only gateways/ethernet may use otherwise.
#include <linux/if_ether.h>
#include <linux/if_packet.h>

namespace gridspace::ethernet {
namespace {

std::int64_t read_clock(clockid_t clock) {
    timespec t{};
    ::clock_gettime(clock, &t);
    return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}
std::int64_t now() {
    return read_clock(CLOCK_MONOTONIC);
}

Port open(std::string const& interface, bool receive) {
    PortOptions options;
    options.interface = interface;
    options.receive = receive;
    options.filter.ethertypes = {iec61850::kSvEthertype};
    options.ring_frames = 32'768;
    auto port = Port::open(options);
    if (!port) {
        fmt::print(stderr, "{}\n", describe(port.error()));
        std::exit(3);
    }
    return std::move(*port);
}

std::vector<std::uint8_t> example_frame() {
    iec61850::AsduDescription d;
    d.sv_id = "GS_TL2_MU21";
    d.sample_octets = 12;
    auto const t =
        iec61850::SvTemplate::create({*Mac::parse("01:0C:CD:04:00:21"), {}, iec61850::VlanTag{}, 0x4021, false}, {d});
    return {t->frame().begin(), t->frame().end()};
}

void throughput() {
    Port sender = open("left", false);
    std::vector<std::uint8_t> const frame = example_frame();
    std::vector<Octets> const batch(64, Octets{frame});
    constexpr std::size_t kFrames = 192'000;
    auto const measure = [&](auto&& send) {
        std::int64_t const start = now(), cpu = read_clock(CLOCK_THREAD_CPUTIME_ID);
        for (std::size_t sent = 0; sent < kFrames;) {
            sent += send();
        }
        std::int64_t const cpu_end = read_clock(CLOCK_THREAD_CPUTIME_ID);
        return std::pair{kFrames * 1e9 / static_cast<double>(now() - start),
                         static_cast<double>(cpu_end - cpu) / kFrames};
    };
    measure([&] { return sender.send(batch); });
    auto const single = measure([&] { return sender.send(Octets{frame}) ? 1U : 0U; });
    auto const many = measure([&] { return sender.send(batch); });
    fmt::print("  \"send_single_per_s\": {:.0f}, \"send_batch_per_s\": {:.0f}, \"batch_gain\": {:.2f}, "
               "\"send_batch_cpu_ns\": {:.0f},\n",
               single.first, many.first, many.first / single.first, many.second);
    for (bool const ring : {true, false}) {
        PortOptions options{.interface = "right", .filter = {}, .receive = true};
        options.filter.ethertypes = {iec61850::kSvEthertype};
        options.ring = ring;
        options.ring_frames = 32'768;
        options.receive_buffer = 64U << 20U;
        auto receiver = Port::open(options);
        for (std::size_t sent = 0; sent < 16'000;) {
            sent += sender.send(batch);
        }
        std::vector<ReceivedFrame> out(64);
        std::size_t count = 0;
        std::int64_t const start = now();
        for (std::size_t n = 0; (n = receiver->receive(out)) > 0;) {
            count += n;
        }
        fmt::print("  \"receive_{}_ns\": {:.0f}, \"receive_{}_dropped\": {},\n", ring ? "ring" : "recvmmsg",
                   static_cast<double>(now() - start) / std::max<double>(1, static_cast<double>(count)),
                   ring ? "ring" : "recvmmsg", receiver->counters().dropped);
    }
}

struct Delays {
    std::vector<double> us;
    [[nodiscard]] double at(double p) { // nearest rank
        std::sort(us.begin(), us.end());
        return us[std::min(us.size() - 1, static_cast<std::size_t>(p * static_cast<double>(us.size())))];
    }
};
constexpr int kPings = 20'000;

/// Half of a round trip through two of our ports, an echo on the other side.
Delays ping_ports() {
    std::atomic<bool> stop{false};
    std::thread echo{[&] {
        Port port = open("right", true);
        std::vector<ReceivedFrame> in(16);
        while (!stop) {
            port.wait(100'000'000);
            for (std::size_t n = port.receive(in), i = 0; i < n; ++i) {
                port.send(in[i].octets);
            }
        }
    }};
    Port port = open("left", true);
    std::vector<std::uint8_t> const frame = example_frame();
    std::vector<ReceivedFrame> in(16);
    Delays out;
    for (int i = 0; i < kPings; ++i) {
        std::int64_t const start = now();
        port.send(frame);
        while (port.wait(100'000'000) && port.receive(in) == 0) {
        }
        out.us.push_back(static_cast<double>(now() - start) / 2000);
    }
    stop = true;
    echo.join();
    return out;
}

int bare_socket(char const* interface) {
    int const fd = ::socket(AF_PACKET, SOCK_RAW, htons(iec61850::kSvEthertype));
    sockaddr_ll address{};
    address.sll_family = AF_PACKET;
    address.sll_protocol = htons(iec61850::kSvEthertype);
    address.sll_ifindex = static_cast<int>(*interface_index(interface));
    ::bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address);
    timeval const timeout{0, 100'000};
    ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
    return fd;
}

Delays ping_bare() {
    std::atomic<bool> stop{false};
    std::thread echo{[&] {
        int const fd = bare_socket("right");
        char buffer[2048];
        while (!stop) {
            if (ssize_t const n = ::recv(fd, buffer, sizeof buffer, 0); n > 0) {
                (void)!::send(fd, buffer, static_cast<std::size_t>(n), 0);
            }
        }
        ::close(fd);
    }};
    int const fd = bare_socket("left");
    std::vector<std::uint8_t> const frame = example_frame();
    char buffer[2048];
    Delays out;
    for (int i = 0; i < kPings; ++i) {
        std::int64_t const start = now();
        (void)!::send(fd, frame.data(), frame.size(), 0);
        (void)!::recv(fd, buffer, sizeof buffer, 0);
        out.us.push_back(static_cast<double>(now() - start) / 2000);
    }
    stop = true;
    echo.join();
    ::close(fd);
    return out;
}

void delays() {
    Delays bare = ping_bare(), ours = ping_ports();
    fmt::print("  \"one_way_us\": {{\"p50\": {:.2f}, \"p99\": {:.2f}, \"p99.9\": {:.2f}}}, \"bare_one_way_us\": "
               "{{\"p50\": {:.2f}, \"p99\": {:.2f}, \"p99.9\": {:.2f}}}, "
               "\"p50_ratio\": {:.3f}",
               ours.at(0.5), ours.at(0.99), ours.at(0.999), bare.at(0.5), bare.at(0.99), bare.at(0.999),
               ours.at(0.5) / bare.at(0.5));
}

} // namespace
} // namespace gridspace::ethernet

int main() {
    using namespace gridspace::ethernet;
    if (::unshare(CLONE_NEWNET | (::geteuid() == 0 ? 0 : CLONE_NEWUSER)) != 0 ||
        std::system("PATH=/usr/sbin:/sbin:$PATH; ip link add left type veth peer name right && ip link set left up && "
                    "ip link set right up") != 0) {
        std::perror("no namespace with a virtual cable");
        return 3;
    }
    ::usleep(200'000); // until the cable carries
    fmt::print("{{\n");
    throughput();
    delays();
    fmt::print("\n}}\n");
    return 0;
}
