// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/ethernet/port.hpp"

#include "gateways/ethernet/packet_socket.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <fmt/format.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>

namespace gridspace::ethernet {

struct Port::Impl {
    /// A socket with its buffer.
    struct Lane {
        PacketSocket socket;
        std::unique_ptr<Receiver> receiver;
    };

    PortOptions options;
    std::vector<Lane> lanes; ///< all frames; or those of `own_sources`, and the others; empty: there is no interface
    UniqueFd either;         ///< of two lanes: an epoll
    PortCounters counters;
    Mac mac;
    std::uint64_t already_received{0}; ///< by the interface, when it was opened
    std::uint64_t accounted_before{0}; ///< of received and dropped, when it was opened
    std::uint64_t for_us{0};           ///< by the kernel's count, since it was opened; fetched or not
    std::uint64_t foreign_before{0};   ///< at interfaces of the same name that are gone

    static constexpr std::size_t kBatch = 64;
    std::array<mmsghdr, kBatch> messages{};
    std::array<iovec, kBatch> parts{};

    Result<void> open_lane(PortOptions const& of_lane) {
        auto made = make_socket(of_lane);
        if (!made) {
            return std::unexpected{made.error()};
        }
        Lane lane{std::move(*made), nullptr};
        if (options.receive) {
            lane.receiver = options.ring ? make_ring(lane.socket.fd.get(), of_lane.ring_frames) : nullptr;
            lane.receiver = lane.receiver ? std::move(lane.receiver) : make_batch_receiver(lane.socket.fd.get());
        }
        lanes.push_back(std::move(lane));
        return {};
    }

    Result<void> open_lanes() {
        if (!options.own_sources || !options.receive) {
            return open_lane(options);
        }
        constexpr std::size_t kOthersShare = 8; // the others' frames may be lost
        PortOptions one = options;
        one.filter.sources = {*options.own_sources, false};
        PortOptions other = options;
        other.filter.sources = {*options.own_sources, true};
        other.ring_frames /= kOthersShare;
        other.receive_buffer /= kOthersShare;
        if (auto ok = open_lane(one); !ok) {
            return ok;
        }
        if (auto ok = open_lane(other); !ok) {
            return ok;
        }
        either.reset(::epoll_create1(EPOLL_CLOEXEC));
        for (Lane const& lane : lanes) {
            epoll_event event{};
            event.events = EPOLLIN;
            if (::epoll_ctl(either.get(), EPOLL_CTL_ADD, lane.socket.fd.get(), &event) != 0) {
                return fail(ExitCode::environment, fmt::format("no epoll: {}", std::strerror(errno)));
            }
        }
        return {};
    }

    Result<void> connect() {
        disconnect();
        if (auto ok = open_lanes(); !ok) {
            disconnect();
            return ok;
        }
        auto const own = interface_mac(options.interface);
        already_received = options.receive ? interface_received(options.interface).value_or(0) : 0;
        accounted_before = counters.received + counters.dropped + counters.others_dropped;
        for_us = 0;
        foreign_before = counters.foreign;
        for (Lane const& lane : lanes) {
            if (auto bound = bind_socket(lane.socket, options); !bound) {
                disconnect();
                return bound;
            }
        }
        mac = own ? *own : Mac{};
        return {};
    }

    void count() {
        for (std::size_t i = 0; i < lanes.size(); ++i) {
            auto const [all, dropped] = take_counts(lanes[i].socket.fd.get());
            for_us += all;
            (i == 0 ? counters.dropped : counters.others_dropped) += dropped;
        }
    }

    void disconnect() {
        count();
        either.reset();
        lanes.clear();
    }

    /// "Network is down" is reported once to each socket; until it is fetched, poll() returns at once.
    void take_errors() const noexcept {
        for (Lane const& lane : lanes) {
            int error = 0;
            socklen_t size = sizeof error;
            ::getsockopt(lane.socket.fd.get(), SOL_SOCKET, SO_ERROR, &error, &size);
        }
    }

    [[nodiscard]] unsigned index() const noexcept { return lanes.empty() ? 0 : lanes.front().socket.index; }
    [[nodiscard]] int send_fd() const noexcept { return lanes.empty() ? -1 : lanes.front().socket.fd.get(); }

    /// The first reason is kept: those behind it are often its consequences.
    void not_sent(int error) noexcept { counters.send_error = counters.send_error == 0 ? error : counters.send_error; }

    /// What the kernel could not decide.
    [[nodiscard]] bool wanted(Lane const& lane, ReceivedFrame const& frame) const {
        return (lane.socket.ignores_outgoing || options.include_outgoing || !frame.outgoing) &&
               (lane.socket.kernel_filters || lane.socket.filter.matches(frame.octets));
    }
};

Port::Port(std::unique_ptr<Impl> impl) : impl_{std::move(impl)} {}
Port::Port(Port&&) noexcept = default;
Port& Port::operator=(Port&&) noexcept = default;
Port::~Port() = default;

Result<Port> Port::open(PortOptions options) {
    auto impl = std::make_unique<Impl>();
    impl->options = std::move(options);
    if (auto ok = impl->connect(); !ok) {
        return std::unexpected{ok.error()};
    }
    return Port{std::move(impl)};
}

int Port::fd() const noexcept {
    return impl_->either ? impl_->either.get() : impl_->send_fd();
}
Mac const& Port::mac() const noexcept {
    return impl_->mac;
}
std::string const& Port::interface() const noexcept {
    return impl_->options.interface;
}
bool Port::uses_ring() const noexcept {
    return !impl_->lanes.empty() && impl_->lanes.front().receiver && impl_->lanes.front().receiver->is_ring();
}

PortCounters const& Port::counters() noexcept {
    impl_->count();
    return impl_->counters;
}

std::uint64_t Port::foreign() {
    Impl& impl = *impl_;
    auto const all =
        impl.options.receive && !impl.lanes.empty() ? interface_received(impl.options.interface) : std::nullopt;
    if (all) {
        std::uint64_t const since = *all - std::min(impl.already_received, *all);
        impl.count();
        PacketSocket const& socket = impl.lanes.front().socket;
        bool const kernel_knows = socket.kernel_filters && socket.ignores_outgoing;
        std::uint64_t const ours = kernel_knows ? impl.for_us
                                                : impl.counters.received + impl.counters.dropped +
                                                      impl.counters.others_dropped - impl.accounted_before;
        // The count of the interface is a moment older: what came meanwhile must not take anything back.
        impl.counters.foreign = std::max(impl.counters.foreign, impl.foreign_before + (since - std::min(ours, since)));
    }
    return impl.counters.foreign;
}

std::size_t Port::receive(std::span<ReceivedFrame> out) noexcept {
    if (impl_->lanes.empty() || !impl_->options.receive) {
        return 0;
    }
    constexpr int kRounds = 64; // of foreign frames only: behind them something of ours may wait
    std::size_t kept = 0;
    for (int round = 0; kept == 0 && round < kRounds; ++round) {
        std::size_t count = 0;
        Impl::Lane* lane = nullptr;
        for (std::size_t i = 0; count == 0 && i < impl_->lanes.size(); ++i) {
            lane = &impl_->lanes[i];
            count = lane->receiver->receive(out);
        }
        if (count == 0) {
            if (impl_->either && impl_->options.waited_for) {
                impl_->take_errors();
            }
            return 0;
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (impl_->wanted(*lane, out[i])) {
                impl_->counters.truncated += out[i].truncated ? 1 : 0;
                out[kept++] = out[i];
            } else {
                ++impl_->counters.filtered;
            }
        }
    }
    impl_->counters.received += kept;
    return kept;
}

bool Port::wait(std::int64_t timeout_ns) const noexcept {
    timespec const timeout{timeout_ns / 1'000'000'000, timeout_ns % 1'000'000'000};
    pollfd entry{fd(), POLLIN, 0}; // an fd of -1 is ignored: the time is waited
    int const ready = ::ppoll(&entry, 1, &timeout, nullptr);
    if (ready > 0 && (entry.revents & POLLERR) != 0) {
        impl_->take_errors();
    }
    return ready > 0 && (entry.revents & POLLIN) != 0;
}

bool Port::send(Octets frame) noexcept {
    Impl& impl = *impl_;
    ssize_t sent = -1;
    do { // one frame alone is cheaper without the batch around it
        sent = !impl.lanes.empty() ? ::send(impl.send_fd(), frame.data(), frame.size(), MSG_DONTWAIT) : -1;
    } while (sent < 0 && !impl.lanes.empty() && errno == EINTR);
    if (sent < 0) {
        impl.not_sent(!impl.lanes.empty() ? errno : ENODEV);
    }
    ++(sent >= 0 ? impl.counters.sent : impl.counters.send_failed);
    return sent >= 0;
}

std::size_t Port::send(std::span<Octets const> frames) noexcept {
    if (frames.size() == 1) {
        return send(frames.front()) ? 1 : 0;
    }
    Impl& impl = *impl_;
    std::size_t taken = 0, at = 0;
    while (at < frames.size() && !impl.lanes.empty()) {
        std::size_t const batch = std::min(frames.size() - at, Impl::kBatch);
        for (std::size_t i = 0; i < batch; ++i) {
            // sendmmsg does not write to what it sends
            impl.parts[i] = {const_cast<std::uint8_t*>(frames[at + i].data()), frames[at + i].size()};
            impl.messages[i].msg_hdr = {};
            impl.messages[i].msg_hdr.msg_iov = &impl.parts[i];
            impl.messages[i].msg_hdr.msg_iovlen = 1;
        }
        int sent = ::sendmmsg(impl.send_fd(), impl.messages.data(), static_cast<unsigned>(batch), MSG_DONTWAIT);
        if (sent < 0 && errno == ENOSYS) {
            sent = ::sendmsg(fd(), &impl.messages[0].msg_hdr, MSG_DONTWAIT) < 0 ? -1 : 1;
        }
        if (sent < 0 && errno == EINTR) {
            continue;
        }
        if (sent < 0) {
            impl.not_sent(errno);
        }
        // A frame that fails is left out: the next one is newer, and a sampled value that is late is worth nothing.
        taken += sent > 0 ? static_cast<std::size_t>(sent) : 0;
        at += sent > 0 ? static_cast<std::size_t>(sent) : 1;
    }
    if (impl.lanes.empty() && !frames.empty()) {
        impl.not_sent(ENODEV);
    }
    impl.counters.sent += taken;
    impl.counters.send_failed += frames.size() - taken;
    return taken;
}

LinkState Port::maintain() {
    Impl& impl = *impl_;
    LinkState state = link_state(impl.options.interface, impl.index());
    if (state == LinkState::missing || state == LinkState::renamed) {
        impl.disconnect(); // what is called something else now is somebody else's
        return state;
    }
    auto const index = interface_index(impl.options.interface);
    if (index && *index != impl.index()) { // it is back, or it is another one of the same name
        if (!impl.connect()) {
            return LinkState::missing;
        }
        ++impl.counters.reconnects;
    }
    return state;
}

} // namespace gridspace::ethernet
