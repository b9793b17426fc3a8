// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/app/frame_capture.hpp"

#include "bus/lockstep/barrier.hpp"
#include "common/text.hpp"
#include "common/unique_fd.hpp"
#include "gateways/ethernet/boxed_ip.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <future>
#include <poll.h>
#include <sched.h>
#include <tuple>

namespace gridspace::recorder {
namespace {

/// Real time: frames that wait for a disk which hangs, in octets. What comes on top is dropped and counted.
constexpr std::size_t kMaxWaiting = 32U << 20U;

// As many may wait as that, and those of two ticks with as many each (launcher/scenario/dataflow.cpp), and GOOSE.
static_assert(4 * lockstep::Barrier::kMostFrames <= ethernet::PortOptions::kRingFrames);

/// A port and a way through it in one number, which a frame carries through its reader.
std::uint32_t place_of(std::size_t port, bool outgoing) {
    return static_cast<std::uint32_t>(2 * port) + (outgoing ? 1 : 0);
}
std::size_t port_of(std::uint32_t place) {
    return place / 2;
}
bool is_outgoing(std::uint32_t place) {
    return place % 2 != 0;
}

/// What neither this framework nor the IP of its hosts sends.
bool is_other(std::uint16_t ethertype) {
    constexpr std::array<std::uint16_t, 5> kKnown{iec61850::kSvEthertype, iec61850::kGooseEthertype, 0x0800 /*IPv4*/,
                                                  0x0806 /*ARP*/, 0x86dd /*IPv6*/};
    return std::find(kKnown.begin(), kKnown.end(), ethertype) == kKnown.end();
}

/// GRIDSPACE_NETWORKS: "HOST=FILE HOST=FILE".
std::map<std::string, std::filesystem::path> networks_of_hosts() {
    std::map<std::string, std::filesystem::path> out;
    char const* const text = std::getenv("GRIDSPACE_NETWORKS");
    for (std::string const& word : split(text == nullptr ? "" : text, ' ')) {
        if (auto const equals = word.find('='); equals != std::string::npos) {
            out[word.substr(0, equals)] = word.substr(equals + 1);
        }
    }
    return out;
}

/// Brings this thread into a network namespace; a socket stays where it was made.
Result<void> enter(std::string const& whose, std::filesystem::path const& network) {
    if (network.empty()) {
        return {}; // nothing was said: everything is where this process is
    }
    UniqueFd const fd{::open(network.c_str(), O_RDONLY | O_CLOEXEC)};
    if (!fd || ::setns(fd.get(), CLONE_NEWNET) != 0) {
        return fail(
            ExitCode::environment,
            fmt::format("cannot enter the network of {} ({}): {}", whose, network.string(), std::strerror(errno)),
            "record.frames: none goes without the capture");
    }
    return {};
}

} // namespace

Result<std::unique_ptr<FrameCapture>> FrameCapture::open(bus::Node& node, CaptureConfig const& config) {
    auto out = std::unique_ptr<FrameCapture>{new FrameCapture{node}};
    if (config.ports.empty()) {
        return out;
    }
    auto file = pcapng::Writer::create(config.file, "Gridspace");
    if (!file) {
        return std::unexpected{file.error()};
    }
    out->file_ = std::make_unique<pcapng::Writer>(std::move(*file));
    for (CaptureConfig::Port const& port : config.ports) {
        Port p;
        p.name = port.name;
        p.interface = out->file_->add_interface(port.name, port.description);
        p.both_ways = port.both_ways;
        p.in = out->way_of(port.link);
        p.out = port.both_ways ? out->way_of(port.link_out) : Way{};
        out->ports_.push_back(std::move(p));
    }
    // A thread may be in another network namespace than its process: where the switches are.
    std::promise<Result<void>> opened;
    auto result = opened.get_future();
    out->thread_ = std::thread{[raw = out.get(), &config, &opened] {
        auto ok = raw->open_ports(config);
        bool const good = ok.has_value();
        opened.set_value(std::move(ok));
        if (good && !raw->node_.lockstep()) {
            raw->capture();
        }
    }};
    if (auto ok = result.get(); !ok) {
        return std::unexpected{ok.error()};
    }
    if (node.lockstep()) { // frames are in the rings when their ledgers come
        node.exchange_frames_with([raw = out.get()] { raw->fetch(); }, {});
    }
    return out;
}

FrameCapture::~FrameCapture() {
    stop_ = true;
    if (thread_.joinable()) {
        thread_.join();
    }
}

/// In lockstep only what the ledgers speak of has a place in time; in real time everything is taken as it comes.
FrameCapture::Way FrameCapture::way_of(std::string const& link) {
    if (!node_.lockstep()) {
        bus::WireReader* const all = reader_of({"", 0});
        all->bound(kMaxWaiting);
        return {all, all, all, all};
    }
    if (link.empty()) {
        return {};
    }
    return {reader_of({link, iec61850::kSvEthertype}), reader_of({link, iec61850::kGooseEthertype}),
            reader_of({link, ethernet::kIpEthertype}), nullptr};
}

bus::WireReader* FrameCapture::reader_of(Channel const& channel) {
    auto& reader = readers_[channel];
    if (reader == nullptr) {
        reader = std::make_unique<bus::WireReader>(node_, channel.first, channel.second);
    }
    return reader.get();
}

bus::WireReader* FrameCapture::Way::reader_of(iec61850::Octets frame) const {
    std::uint16_t const channel = ethernet::channel_of(frame);
    return channel == iec61850::kSvEthertype      ? smv
           : channel == iec61850::kGooseEthertype ? goose
           : channel == ethernet::kIpEthertype    ? ip
                                                  : other;
}

Result<void> FrameCapture::open_ports(CaptureConfig const& config) {
    std::map<std::string, std::filesystem::path> const networks = networks_of_hosts();
    for (std::size_t i = 0; i < ports_.size(); ++i) {
        CaptureConfig::Port const& port = config.ports[i];
        auto const known = networks.find(port.host);
        if (!port.host.empty() && known == networks.end()) {
            return fail(ExitCode::environment,
                        fmt::format("where the network of host '{}' is, is not known", port.host),
                        "`gridspace run` says it in GRIDSPACE_NETWORKS");
        }
        if (auto ok = port.host.empty() ? enter("the switches", config.network_namespace)
                                        : enter(fmt::format("host '{}'", port.host), known->second);
            !ok) {
            return ok;
        }
        ethernet::PortOptions options;
        options.interface = port.interface;
        options.promiscuous = true;
        options.include_outgoing = port.both_ways;
        if (node_.lockstep()) {
            options.own_sources = lockstep::kRunAddressOctets;
            options.waited_for = false;
        }
        auto socket = ethernet::Port::open(options);
        if (!socket) {
            return std::unexpected{socket.error()};
        }
        ports_[i].socket = std::make_unique<ethernet::Port>(std::move(*socket));
    }
    return {};
}

void FrameCapture::capture() {
    constexpr int kLookForStopMs = 50;
    std::vector<pollfd> waiting(ports_.size());
    while (!stop_) {
        for (std::size_t i = 0; i < ports_.size(); ++i) {
            waiting[i] = {ports_[i].socket->fd(), POLLIN, 0};
        }
        ::poll(waiting.data(), waiting.size(), kLookForStopMs);
        for (std::size_t i = 0; i < ports_.size(); ++i) {
            if ((waiting[i].revents & POLLERR) != 0) {
                ports_[i].socket->wait(0); // takes the error ("network is down") away
            }
        }
        fetch();
    }
}

void FrameCapture::fetch() {
    for (std::size_t i = 0; i < ports_.size(); ++i) {
        auto& socket = *ports_[i].socket;
        for (std::size_t n = 0, times = 0; times < ethernet::kMostBatches && (n = socket.receive(batch_)) > 0;
             ++times) {
            for (std::size_t k = 0; k < n; ++k) {
                ethernet::ReceivedFrame const& frame = batch_[k];
                Way const& way = frame.outgoing ? ports_[i].out : ports_[i].in;
                std::uint16_t const ethertype = iec61850::ethertype_of(frame.octets);
                if (auto* reader = way.reader_of(frame.octets)) {
                    bool const taken =
                        reader->push(std::as_bytes(frame.octets), frame.stamp_ns, place_of(i, frame.outgoing));
                    ports_[i].no_room += taken ? 0 : 1;
                } else if (node_.lockstep() && is_other(ethertype)) {
                    ports_[i].others.add(lockstep::source_of(std::as_bytes(frame.octets)));
                }
            }
        }
    }
}

std::vector<std::string> FrameCapture::strangers() const {
    std::vector<std::string> out;
    for (Port const& port : ports_) {
        if (port.others.total() > 0) {
            out.push_back(fmt::format("{} frames that are neither SMV, GOOSE nor IP at '{}': {}", port.others.total(),
                                      port.name, port.others.text()));
        }
        if (std::uint64_t const lost = node_.lockstep() ? port.socket->counters().others_dropped : 0; lost > 0) {
            out.push_back(fmt::format("{} frames at '{}' from addresses that are not of this run came faster than they "
                                      "could be looked at",
                                      lost, port.name));
        }
    }
    return out;
}

void FrameCapture::take_due() {
    if (node_.lockstep() && file_ != nullptr) {
        fetch(); // what nobody has announced, too: it makes room, and is counted
    }
    due_.clear();
    for (auto const& [channel, reader] : readers_) {
        auto const frames = reader->take();
        due_.insert(due_.end(), frames.begin(), frames.end());
    }
    std::sort(due_.begin(), due_.end(),
              [lockstep = node_.lockstep()](bus::WireFrame const* a, bus::WireFrame const* b) {
                  return lockstep ? std::tie(a->time, a->port, a->octets) < std::tie(b->time, b->port, b->octets)
                                  : a->kernel_ns < b->kernel_ns;
              });
}

Result<void> FrameCapture::write_taken() {
    bool const lockstep = node_.lockstep();
    std::int64_t const epoch_ns = node_.config().clock.epoch_unix_s * 1'000'000'000;
    for (bus::WireFrame const* frame : due_) {
        std::span<std::uint8_t const> const octets{reinterpret_cast<std::uint8_t const*>(frame->octets.data()),
                                                   frame->octets.size()};
        std::int64_t const stamp = lockstep ? epoch_ns + node_.time_base().nanoseconds(frame->time) : frame->kernel_ns;
        std::string const comment =
            lockstep ? "" : fmt::format("simulated time {:.6f} s", node_.time_base().seconds(frame->time));
        Port const& port = ports_[port_of(frame->port)];
        auto const direction = !port.both_ways            ? pcapng::Direction::unknown
                               : is_outgoing(frame->port) ? pcapng::Direction::outbound
                                                          : pcapng::Direction::inbound;
        if (auto ok = file_->write(port.interface, stamp, octets, comment, direction); !ok) {
            return ok;
        }
    }
    return {};
}

Result<void> FrameCapture::close() {
    if (file_ == nullptr || !thread_.joinable()) {
        return {}; // nothing is captured, or it is closed already
    }
    stop_ = true;
    thread_.join();
    for (Port& port : ports_) {
        auto const& counters = port.socket->counters();
        // In lockstep nothing is lost (a ledger would miss it), and the kernel's counts include what came after the
        // end.
        if (!node_.lockstep()) {
            std::uint64_t const dropped = counters.dropped + port.no_room;
            dropped_ += dropped;
            if (auto ok = file_->statistics(port.interface, 0, counters.received, dropped); !ok) {
                return ok;
            }
        }
    }
    return file_->close();
}

} // namespace gridspace::recorder
