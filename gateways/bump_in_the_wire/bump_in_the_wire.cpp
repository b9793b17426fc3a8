// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/bump_in_the_wire/bump_in_the_wire.hpp"

#include "bus/wire.hpp"
#include "gateways/bump_in_the_wire/delay_line.hpp"
#include "gateways/ethernet/boxed_ip.hpp"
#include "gateways/ethernet/port.hpp"
#include "gateways/port/wire_clock.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <fmt/format.h>
#include <map>
#include <poll.h>
#include <sys/prctl.h>
#include <thread>

namespace gridspace::gateways {
namespace {

constexpr std::size_t kWaitingFrames = 16'384; ///< more than a second of three streams

Result<ethernet::Port> open_port(bus::Node const& node, std::string const& interface, bool receive) {
    ethernet::PortOptions options;
    options.interface = interface;
    options.receive = receive;
    options.promiscuous = receive; // what is for others passes here too
    if (node.lockstep()) {
        options.own_sources = lockstep::kRunAddressOctets;
    }
    return ethernet::Port::open(options);
}

/// IP of the kernels passes untouched.
bool is_for_hooks(std::uint16_t channel) {
    return channel == iec61850::kSvEthertype || channel == iec61850::kGooseEthertype ||
           channel == ethernet::kIpEthertype;
}

} // namespace

/// One direction.
struct BumpInTheWire::Way final : FrameOutput {
    Way(bus::Node& n, std::optional<BumpConfig::Way> const& config, FrameHook* h, double s)
        : node{n}, clock{n}, hook{config ? h : nullptr}, only_heard{config && config->out.empty()}, speed{s} {
        if (!config || !node.lockstep()) {
            return;
        }
        for (std::uint16_t const ethertype : config->ethertypes) {
            readers[ethertype] = std::make_unique<bus::WireReader>(node, config->in, ethertype);
            if (!only_heard) {
                writers[ethertype] = std::make_unique<bus::WireWriter>(node, config->out, ethertype);
            }
        }
    }

    void send(std::span<std::uint8_t const> octets, std::int64_t delay_ns) override {
        assert(delay_ns >= 0);
        if (only_heard) {
            return;
        }
        std::int64_t at_ns = 0;
        if (node.lockstep()) {
            at_ns = clock.of(clock.at_or_after(now_ns + delay_ns));
        } else if (delay_ns > 0) {
            at_ns = clock.now() + static_cast<std::int64_t>(static_cast<double>(delay_ns) / speed);
        } else {
            depart(octets, {});
            return;
        }
        if (!line.push(at_ns, octets)) {
            ++lost;
        }
    }

    void depart(std::span<std::uint8_t const> octets, SimTime at) {
        if (node.lockstep()) {
            auto const writer = writers.find(ethernet::channel_of(octets));
            if (writer == writers.end()) {
                node.fail_with({ExitCode::environment,
                                fmt::format("a frame of ethertype {:#06x} that no receiver waits for",
                                            iec61850::ethertype_of(octets)),
                                ""});
                return;
            }
            writer->second->sent(std::as_bytes(octets), at);
        }
        if (out->send(octets)) {
            ++sent;
            return;
        }
        ++lost;
        if (node.lockstep()) {
            node.fail_with({ExitCode::environment,
                            fmt::format("the kernel did not take a frame on '{}'", out->interface()),
                            "is the link up?"});
        }
    }

    /// Frames of the hook's own up to and including `until_ns`.
    void elapse(std::int64_t until_ns) {
        if (hook == nullptr) {
            return;
        }
        for (auto due = hook->due(); due && *due <= until_ns; due = hook->due()) {
            now_ns = std::max(now_ns, *due);
            hook->elapse(now_ns, *this);
        }
    }

    /// Lockstep: what has come for the tick that ends now, in the order of time.
    void take() {
        frames.clear();
        passed = 0;
        for (auto const& [ethertype, reader] : readers) {
            auto const due = reader->take();
            frames.insert(frames.end(), due.begin(), due.end());
        }
        std::sort(frames.begin(), frames.end(), [](bus::WireFrame const* a, bus::WireFrame const* b) {
            return a->time != b->time ? a->time < b->time : a->octets < b->octets;
        });
    }
    [[nodiscard]] bus::WireFrame const* next() const { return passed < frames.size() ? frames[passed] : nullptr; }

    void pass_next(SimTime end) {
        bus::WireFrame const* const frame = frames[passed++];
        if (frame->time <= end - node.time_base().nearest(node.config().clock.tick_s) && end.quanta > 0) {
            ++lost; // came while this process was paused: a cable without anybody in it
            return;
        }
        now_ns = clock.of(frame->time);
        ++received;
        hook->pass({{reinterpret_cast<std::uint8_t const*>(frame->octets.data()), frame->octets.size()}, now_ns},
                   *this);
    }

    void finish(SimTime end) {
        std::int64_t const end_ns = clock.of(end);
        elapse(end_ns);
        while (auto const waiting = line.pop(end_ns)) {
            depart(waiting->octets, node.time_base().from_nanoseconds(waiting->at_ns));
        }
    }

    void realtime_frame(ethernet::ReceivedFrame const& frame, std::int64_t simulated_ns) {
        now_ns = simulated_ns;
        ++received;
        hook->pass({frame.octets, simulated_ns}, *this);
    }

    void realtime_elapse(std::int64_t simulated_ns) {
        elapse(simulated_ns);
        while (auto const waiting = line.pop(clock.now())) {
            depart(waiting->octets, {});
        }
    }

    [[nodiscard]] Counters counters() const { return {received, sent, lost}; }

    bus::Node& node;
    WireClock clock;
    FrameHook* hook; ///< null: this direction passes untouched
    bool only_heard; ///< it passes untouched too
    double speed;
    ethernet::Port* out{nullptr};
    std::map<std::uint16_t, std::unique_ptr<bus::WireReader>> readers; ///< lockstep
    std::map<std::uint16_t, std::unique_ptr<bus::WireWriter>> writers;
    std::vector<bus::WireFrame const*> frames;
    std::size_t passed{0}; ///< of them
    DelayLine line{kWaitingFrames};
    std::int64_t now_ns{0}; ///< simulated: of what the hook is called for
    std::atomic<std::uint64_t> received{0}, sent{0}, lost{0};
};

struct BumpInTheWire::Impl {
    Impl(bus::Node& n, BumpConfig const& config, double s, Hooks hooks)
        : node{n}, clock{n}, speed{s}, from_host{n, config.from_host, hooks.from_host, s},
          to_host{n, config.to_host, hooks.to_host, s} {}

    /// One side's receiving socket; what passes untouched, and in real time everything, leaves through the other
    /// side's.
    struct Side {
        std::unique_ptr<ethernet::Port> port;
        Way* way{nullptr};
        ethernet::Port* opposite{nullptr};
    };

    /// Simulated time of an instant of the machine's clock.
    std::int64_t simulated(std::int64_t unix_ns) {
        if (start_unix_ns == 0) {
            start_unix_ns = node.start_unix_ns(); // until the first clock has come
        }
        return start_unix_ns == 0 ? -1
                                  : static_cast<std::int64_t>(static_cast<double>(unix_ns - start_unix_ns) * speed);
    }

    void receive(Side& side) {
        for (std::size_t n = 0, times = 0; times < ethernet::kMostBatches && (n = side.port->receive(batch)) > 0;
             ++times) {
            for (std::size_t i = 0; i < n; ++i) {
                ethernet::ReceivedFrame const& frame = batch[i];
                std::uint16_t const channel = ethernet::channel_of(frame.octets);
                bool const in_hands = side.way->hook != nullptr && is_for_hooks(channel);
                if (!in_hands || side.way->only_heard) {
                    (void)side.opposite->send(frame.octets);
                }
                if (!in_hands) {
                    continue;
                }
                if (node.lockstep()) {
                    // Without a reader nobody of the run sends it: it has no place in simulated time.
                    if (auto const reader = side.way->readers.find(channel); reader != side.way->readers.end()) {
                        reader->second->push(std::as_bytes(frame.octets), frame.stamp_ns);
                    }
                } else {
                    side.way->realtime_frame(frame, simulated(frame.stamp_ns != 0 ? frame.stamp_ns : clock.utc_ns(0)));
                }
            }
        }
    }

    /// How long nothing is due, in real time.
    [[nodiscard]] std::int64_t idle_ns() {
        constexpr std::int64_t kLookForStopNs = 50'000'000;
        std::int64_t out = kLookForStopNs;
        for (Way* way : {&from_host, &to_host}) {
            if (node.lockstep() || way->hook == nullptr) {
                continue;
            }
            if (auto const next = way->line.next_ns()) {
                out = std::min(out, *next - clock.now());
            }
            if (auto const due = way->hook->due(); due && start_unix_ns != 0) {
                out = std::min(
                    out, static_cast<std::int64_t>(static_cast<double>(*due - simulated(clock.utc_ns(0))) / speed));
            }
        }
        return std::max<std::int64_t>(out, 0);
    }

    void pump() {
        ::prctl(PR_SET_TIMERSLACK, 1UL); // delays of some ten microseconds are meant so
        auto maintained = std::chrono::steady_clock::now();
        while (!stop) {
            std::array<pollfd, 2> waiting{pollfd{sides[0].port->fd(), POLLIN, 0},
                                          pollfd{sides[1].port->fd(), POLLIN, 0}};
            std::int64_t const idle = idle_ns();
            timespec const timeout{idle / 1'000'000'000, idle % 1'000'000'000};
            ::ppoll(waiting.data(), waiting.size(), &timeout, nullptr);
            for (std::size_t i = 0; i < 2; ++i) {
                if ((waiting[i].revents & POLLERR) != 0) {
                    sides[i].port->wait(0); // takes the error ("network is down") away
                }
                receive(sides[i]);
            }
            if (!node.lockstep()) {
                std::int64_t const now = simulated(clock.utc_ns(0));
                for (Way* way : {&from_host, &to_host}) {
                    if (way->hook != nullptr) {
                        way->realtime_elapse(now);
                    }
                }
            }
            if (auto const now = std::chrono::steady_clock::now(); now - maintained > std::chrono::milliseconds{200}) {
                maintained = now;
                for (Side& side : sides) {
                    side.port->maintain();
                }
            }
        }
    }

    bus::Node& node;
    WireClock clock;
    double speed;
    Way from_host, to_host;
    std::array<Side, 2> sides;                              ///< towards the host, towards the switch
    std::array<std::unique_ptr<ethernet::Port>, 2> senders; ///< lockstep: the process's thread sends, besides the pump
    std::array<ethernet::ReceivedFrame, 64> batch;
    std::int64_t start_unix_ns{0};
    std::atomic<bool> stop{false};
    std::thread thread;
};

BumpInTheWire::BumpInTheWire(std::unique_ptr<Impl> impl) : impl_{std::move(impl)} {}

BumpInTheWire::~BumpInTheWire() {
    impl_->stop = true;
    if (impl_->thread.joinable()) {
        impl_->thread.join();
    }
}

Result<std::unique_ptr<BumpInTheWire>> BumpInTheWire::open(bus::Node& node, BumpConfig const& config, double speed,
                                                           Hooks hooks) {
    assert(!config.from_host || hooks.from_host != nullptr);
    assert(!config.to_host || hooks.to_host != nullptr);
    auto impl = std::make_unique<Impl>(node, config, speed, hooks);
    std::array<std::string const*, 2> const interfaces{&config.host_interface, &config.switch_interface};
    for (std::size_t i = 0; i < 2; ++i) {
        for (bool const receive : {true, false}) {
            auto port = open_port(node, *interfaces[i], receive);
            if (!port) {
                return std::unexpected{port.error()};
            }
            (receive ? impl->sides[i].port : impl->senders[i]) = std::make_unique<ethernet::Port>(std::move(*port));
        }
    }
    impl->sides[0].way = &impl->from_host;
    impl->sides[1].way = &impl->to_host;
    for (std::size_t i = 0; i < 2; ++i) {
        impl->sides[i].opposite = impl->sides[1 - i].port.get();
        // Lockstep sends from another thread than the pump's, and a port is for one.
        impl->sides[i].way->out = node.lockstep() ? impl->senders[1 - i].get() : impl->sides[1 - i].port.get();
    }
    impl->thread = std::thread{[raw = impl.get()] { raw->pump(); }};
    return std::unique_ptr<BumpInTheWire>{new BumpInTheWire{std::move(impl)}};
}

void BumpInTheWire::work(SimTime end) {
    if (!impl_->node.lockstep()) {
        return;
    }
    std::array<Way*, 2> const ways{&impl_->from_host, &impl_->to_host};
    for (Way* way : ways) {
        way->take();
    }
    // Both directions in one order of time: a hook of one may act on what passes in the other.
    for (;;) {
        bus::WireFrame const *const from = ways[0]->next(), *const to = ways[1]->next();
        if (from == nullptr && to == nullptr) {
            break;
        }
        Way& way = from != nullptr && (to == nullptr || from->time <= to->time) ? *ways[0] : *ways[1];
        std::int64_t const at_ns = impl_->clock.of(way.next()->time);
        for (Way* each : ways) {
            each->elapse(at_ns - 1); // at equal times the frame comes first
        }
        way.pass_next(end);
    }
    for (Way* way : ways) {
        way->finish(end);
    }
}

std::uint64_t BumpInTheWire::next_tick(bus::TickGrid const& grid) const {
    std::uint64_t out = bus::TickGrid::kNever;
    for (Way const* way : {&impl_->from_host, &impl_->to_host}) {
        if (way->hook == nullptr) {
            continue;
        }
        for (auto const& [ethertype, reader] : way->readers) {
            if (auto const time = reader->next()) { // announced before its time
                out = std::min(out, grid.tick_of(*time));
            }
        }
        for (auto const& due : {way->line.next_ns(), way->hook->due()}) {
            if (due) {
                out = std::min(out, grid.tick_of(way->clock.at_or_after(*due)));
            }
        }
    }
    return out;
}

BumpInTheWire::Counters BumpInTheWire::from_host() const {
    return impl_->from_host.counters();
}
BumpInTheWire::Counters BumpInTheWire::to_host() const {
    return impl_->to_host.counters();
}

} // namespace gridspace::gateways
