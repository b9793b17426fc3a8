// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Many sampled-value streams at once, from one thread to another over a virtual cable in a namespace of its own: ours
// (templates, ring, decoder, supervision of every stream) compared with bare sockets that send equal frames, in
// the same run. Delays are from the instant at which a frame is due until the receiver has read it. Prints JSON;
// asserts nothing.
//   bench_wire_streams [--seconds S]
#include "gateways/ethernet/port.hpp"
#include "gateways/iec61850/sv_publisher.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fmt/format.h>
#include <memory>
#include <sched.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

// The baseline is what anybody would write without us, so it needs what only gateways/ethernet may use otherwise.
#include <linux/if_ether.h>
#include <linux/if_packet.h>

namespace gridspace::ethernet {
namespace {

struct Profile {
    char const* name;
    std::size_t streams;
    std::int64_t rate_hz; ///< samples per second
    std::size_t asdus;    ///< of a frame: consecutive samples
};

// Data sets of four currents and four voltages, each with its quality: 64 octets (9-2LE, IEC 61869-9).
constexpr Profile kProfiles[] = {{"6 x 4800 Hz", 6, 4800, 1},
                                 {"64 x 4800 Hz", 64, 4800, 1},
                                 {"64 x F4800S2I4U4", 64, 4800, 2},
                                 {"16 x F14400S6I4U4", 16, 14400, 6},
                                 {"64 x 80 samples per cycle of 50 Hz", 64, 4000, 1}};
constexpr std::size_t kSampleOctets = 64;
constexpr std::uint16_t kFirstAppId = 0x4000;

struct Result {
    std::uint64_t sent{0}, received{0}, lost{0}, wrong{0};
    double send_cpu_ns{0}, receive_cpu_ns{0}; ///< of a frame
    std::vector<float> delays_us;

    [[nodiscard]] double delay(double p) { // nearest rank
        if (delays_us.empty()) {
            return 0;
        }
        auto const at =
            std::min(delays_us.size() - 1, static_cast<std::size_t>(p * static_cast<double>(delays_us.size())));
        std::nth_element(delays_us.begin(), delays_us.begin() + static_cast<std::ptrdiff_t>(at), delays_us.end());
        return static_cast<double>(delays_us[at]);
    }
};

std::int64_t read_clock(clockid_t clock) {
    timespec t{};
    ::clock_gettime(clock, &t);
    return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}
std::int64_t now() {
    return read_clock(CLOCK_MONOTONIC);
}

iec61850::SvTemplate frame_of(Profile const& profile, std::size_t stream) {
    iec61850::AsduDescription d;
    d.sv_id = fmt::format("MU{:02}", stream);
    d.sample_octets = kSampleOctets;
    auto const app_id = static_cast<std::uint16_t>(kFirstAppId + stream);
    return *iec61850::SvTemplate::create(
        {*Mac::parse("01:0C:CD:04:00:21"), *Mac::parse("02:00:00:00:00:01"), iec61850::VlanTag{}, app_id, false},
        std::vector<iec61850::AsduDescription>(profile.asdus, d));
}

/// What the sender and the receiver of one measurement share.
struct Measurement {
    Profile profile;
    std::int64_t start_ns;
    std::int64_t end_ns;
    std::atomic<bool> ready{false}, stop{false};

    [[nodiscard]] iec61850::SendSchedule schedule() const {
        return {Rational{profile.rate_hz}, profile.asdus, start_ns};
    }
    /// When a frame whose last sample has this number is due.
    [[nodiscard]] std::int64_t due_ns(std::int64_t sample) const {
        return start_ns + iec61850::SampleGrid{Rational{profile.rate_hz}}.nanoseconds(sample);
    }
};

/// Calls `send(frame)` at each frame's instant, and returns how many there were.
template <class Send>
std::int64_t at_their_instants(Measurement const& m, Send const& send) {
    auto schedule = m.schedule();
    while (now() < m.end_ns) {
        timespec const at{schedule.due_ns() / 1'000'000'000, schedule.due_ns() % 1'000'000'000};
        ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr);
        for (std::size_t owed = schedule.owed(now(), 64); owed > 0; --owed) {
            send(schedule.next_frame());
            schedule.sent(1);
        }
    }
    return schedule.next_frame();
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

void receive_with_ports(Measurement& m, Result& out) {
    Port port = open("right", true);
    auto frame = std::make_unique<iec61850::SvFrame>();
    std::vector<iec61850::SvSubscriber> subscribers;
    for (std::size_t i = 0; i < m.profile.streams; ++i) {
        iec61850::SvSubscription s;
        s.sv_id = fmt::format("MU{:02}", i);
        s.app_id = static_cast<std::uint16_t>(kFirstAppId + i);
        s.sample_octets = kSampleOctets;
        s.rate_hz = static_cast<double>(m.profile.rate_hz);
        s.wrap = static_cast<std::uint32_t>(m.profile.rate_hz);
        subscribers.emplace_back(s);
    }
    std::vector<ReceivedFrame> in(128);
    m.ready = true;
    std::uint64_t frames = 0;
    std::int64_t const cpu = read_clock(CLOCK_THREAD_CPUTIME_ID);
    while (!m.stop || port.wait(1)) {
        port.wait(10'000'000);
        for (std::size_t n = port.receive(in), i = 0; i < n; ++i) {
            if (!decode_sv(in[i].octets, *frame)) {
                continue;
            }
            ++frames;
            std::size_t const at = frame->header.app_id - std::size_t{kFirstAppId};
            if (at >= subscribers.size()) {
                continue;
            }
            for (auto const& asdu : frame->asdus) {
                if (subscribers[at].is_mine(asdu) && subscribers[at].is_addressed(frame->header)) {
                    subscribers[at].receive(frame->header, asdu, in[i].stamp_ns);
                }
            }
            out.delays_us.push_back(static_cast<float>(now() - m.due_ns(subscribers[at].last_index())) / 1e3F);
        }
    }
    out.receive_cpu_ns = static_cast<double>(read_clock(CLOCK_THREAD_CPUTIME_ID) - cpu) /
                         static_cast<double>(std::max<std::uint64_t>(1, frames));
    out.received = frames;
    for (auto const& s : subscribers) {
        out.lost += s.counters().lost;
        out.wrong += s.counters().of(iec61850::SvEvent::duplicate) + s.counters().of(iec61850::SvEvent::late) +
                     s.counters().of(iec61850::SvEvent::restart);
    }
}

void send_with_ports(Measurement const& m, Result& out) {
    Port port = open("left", false);
    std::vector<iec61850::SvPublisher> publishers;
    for (std::size_t i = 0; i < m.profile.streams; ++i) {
        publishers.emplace_back(frame_of(m.profile, i), static_cast<std::uint32_t>(m.profile.rate_hz));
    }
    std::vector<Octets> batch(m.profile.streams);
    std::int64_t const cpu = read_clock(CLOCK_THREAD_CPUTIME_ID);
    auto const asdus = static_cast<std::int64_t>(m.profile.asdus);
    std::int64_t const frames = at_their_instants(m, [&](std::int64_t frame) {
        for (std::size_t i = 0; i < batch.size(); ++i) {
            for (std::int64_t k = 0; k < asdus; ++k) {
                std::span<std::uint8_t> const sample = publishers[i].sample(frame * asdus + k);
                for (std::size_t value = 0; value < kSampleOctets; value += 8) {
                    iec61850::store_float(sample, value, 1.0F);
                }
                batch[i] = publishers[i].commit();
            }
        }
        port.send(batch);
    });
    out.sent = static_cast<std::uint64_t>(frames) * m.profile.streams;
    out.send_cpu_ns = static_cast<double>(read_clock(CLOCK_THREAD_CPUTIME_ID) - cpu) / static_cast<double>(out.sent);
}

int bare_socket(char const* interface) {
    int const fd = ::socket(AF_PACKET, SOCK_RAW, htons(iec61850::kSvEthertype));
    sockaddr_ll address{};
    address.sll_family = AF_PACKET;
    address.sll_protocol = htons(iec61850::kSvEthertype);
    address.sll_ifindex = static_cast<int>(*interface_index(interface));
    ::bind(fd, reinterpret_cast<sockaddr*>(&address), sizeof address);
    timeval const timeout{0, 10'000};
    ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
    int const octets = 64 << 20;
    ::setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &octets, sizeof octets);
    return fd;
}

/// The frame's number is in its last octets, instead of a counter in each sample.
void receive_bare(Measurement& m, Result& out) {
    int const fd = bare_socket("right");
    std::uint8_t buffer[2048];
    m.ready = true;
    auto const asdus = static_cast<std::int64_t>(m.profile.asdus);
    std::int64_t const cpu = read_clock(CLOCK_THREAD_CPUTIME_ID);
    while (true) {
        ssize_t const n = ::recv(fd, buffer, sizeof buffer, 0);
        if (n < 8) {
            if (m.stop) {
                break;
            }
            continue;
        }
        std::int64_t frame = 0;
        std::memcpy(&frame, buffer + n - 8, 8);
        ++out.received;
        out.delays_us.push_back(static_cast<float>(now() - m.due_ns((frame + 1) * asdus - 1)) / 1e3F);
    }
    out.receive_cpu_ns = static_cast<double>(read_clock(CLOCK_THREAD_CPUTIME_ID) - cpu) /
                         static_cast<double>(std::max<std::uint64_t>(1, out.received));
    ::close(fd);
}

void send_bare(Measurement const& m, Result& out) {
    int const fd = bare_socket("left");
    std::vector<std::vector<std::uint8_t>> frames;
    for (std::size_t i = 0; i < m.profile.streams; ++i) {
        auto const frame = frame_of(m.profile, i);
        frames.emplace_back(frame.frame().begin(), frame.frame().end());
    }
    std::int64_t const cpu = read_clock(CLOCK_THREAD_CPUTIME_ID);
    std::int64_t const sent = at_their_instants(m, [&](std::int64_t number) {
        for (auto& frame : frames) {
            std::memcpy(frame.data() + frame.size() - 8, &number, 8);
            (void)!::send(fd, frame.data(), frame.size(), 0);
        }
    });
    out.sent = static_cast<std::uint64_t>(sent) * m.profile.streams;
    out.send_cpu_ns = static_cast<double>(read_clock(CLOCK_THREAD_CPUTIME_ID) - cpu) / static_cast<double>(out.sent);
    ::close(fd);
}

Result measure(Profile const& profile, double seconds, bool ours) {
    Result out;
    out.delays_us.reserve(static_cast<std::size_t>(
        (seconds + 1) * static_cast<double>(profile.rate_hz * static_cast<std::int64_t>(profile.streams)) /
        static_cast<double>(profile.asdus)));
    Measurement m{.profile = profile, .start_ns = now() + 100'000'000, .end_ns = 0};
    m.end_ns = m.start_ns + static_cast<std::int64_t>(seconds * 1e9);
    std::thread receiver{[&] { ours ? receive_with_ports(m, out) : receive_bare(m, out); }};
    while (!m.ready) {
        ::usleep(100);
    }
    ours ? send_with_ports(m, out) : send_bare(m, out);
    m.stop = true;
    receiver.join();
    return out;
}

void print(Result& result, double seconds) {
    fmt::print("{{\"sent\": {}, \"received\": {}, \"lost\": {}, \"out_of_order\": {}, \"frames_per_s\": {:.0f}, "
               "\"delay_us\": {{\"p50\": {:.1f}, \"p99\": {:.1f}, \"p99.9\": {:.1f}}}, \"send_cpu_ns\": {:.0f}, "
               "\"receive_cpu_ns\": {:.0f}}}",
               result.sent, result.received, result.lost, result.wrong, static_cast<double>(result.received) / seconds,
               result.delay(0.5), result.delay(0.99), result.delay(0.999), result.send_cpu_ns, result.receive_cpu_ns);
}

} // namespace
} // namespace gridspace::ethernet

int main(int argc, char** argv) {
    using namespace gridspace::ethernet;
    double const seconds = argc == 3 && std::strcmp(argv[1], "--seconds") == 0 ? std::atof(argv[2]) : 5;
    if (seconds <= 0 || ::unshare(CLONE_NEWNET | (::geteuid() == 0 ? 0 : CLONE_NEWUSER)) != 0 ||
        std::system("PATH=/usr/sbin:/sbin:$PATH; ip link add left type veth peer name right && ip link set left up && "
                    "ip link set right up") != 0) {
        std::perror("no namespace with a virtual cable");
        return 3;
    }
    ::usleep(200'000); // until the cable carries
    char const* separator = "{\n";
    for (Profile const& profile : kProfiles) {
        auto ours = measure(profile, seconds, true);
        auto bare = measure(profile, seconds, false);
        fmt::print("{}  \"{}\": {{\"streams\": {}, \"samples_per_frame\": {}, \"due_per_s\": {:.0f},\n    \"ours\": ",
                   separator, profile.name, profile.streams, profile.asdus,
                   static_cast<double>(profile.rate_hz) * static_cast<double>(profile.streams) /
                       static_cast<double>(profile.asdus));
        print(ours, seconds);
        fmt::print(",\n    \"bare\": ");
        print(bare, seconds);
        fmt::print("}}");
        separator = ",\n";
    }
    fmt::print("\n}}\n");
    return 0;
}
