// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/app/frame_capture.hpp"

#include "common/unique_fd.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <future>
#include <poll.h>
#include <sched.h>
#include <tuple>

namespace gridspace::recorder {

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
        out->ports_.push_back({port.link, nullptr, out->file_->add_interface(port.name, fmt::format("what is sent into {}", port.name))});
        for (std::uint16_t const ethertype : {iec61850::kSvEthertype, iec61850::kGooseEthertype, std::uint16_t{0}}) {
            auto& reader = out->readers_[{port.link, ethertype}];
            if (reader == nullptr) {
                reader = std::make_unique<bus::WireReader>(node, port.link, ethertype);
            }
        }
    }
    // A thread may be in another network namespace than its process: where the switches are.
    std::promise<Result<void>> opened;
    auto result = opened.get_future();
    out->thread_ = std::thread{[raw = out.get(), &config, &opened] {
        auto ok = raw->open_ports(config);
        bool const good = ok.has_value();
        opened.set_value(std::move(ok));
        if (good) {
            raw->capture();
        }
    }};
    if (auto ok = result.get(); !ok) {
        return std::unexpected{ok.error()};
    }
    return out;
}

FrameCapture::~FrameCapture() {
    stop_ = true;
    if (thread_.joinable()) {
        thread_.join();
    }
}

Result<void> FrameCapture::open_ports(CaptureConfig const& config) {
    if (!config.network_namespace.empty()) {
        UniqueFd const fd{::open(config.network_namespace.c_str(), O_RDONLY | O_CLOEXEC)};
        if (!fd || ::setns(fd.get(), CLONE_NEWNET) != 0) {
            return fail(ExitCode::environment, fmt::format("cannot enter the network of the switches ({}): {}", config.network_namespace.string(),
                                                           std::strerror(errno)),
                        "record.frames: none goes without the capture");
        }
    }
    for (std::size_t i = 0; i < ports_.size(); ++i) {
        ethernet::PortOptions options;
        options.interface = config.ports[i].interface;
        options.promiscuous = true;
        auto socket = ethernet::Port::open(options);
        if (!socket) {
            return std::unexpected{socket.error()};
        }
        ports_[i].socket = std::make_unique<ethernet::Port>(std::move(*socket));
    }
    return {};
}

bus::WireReader* FrameCapture::reader_for(std::size_t port, std::uint16_t ethertype) {
    auto const known = readers_.find({ports_[port].link, ethertype});
    if (known != readers_.end()) {
        return known->second.get();
    }
    // In lockstep only what the ledgers speak of has a place in time.
    return node_.lockstep() ? nullptr : readers_.at({ports_[port].link, 0}).get();
}

void FrameCapture::capture() {
    constexpr int kLookForStopMs = 50;
    std::array<ethernet::ReceivedFrame, 64> batch;
    std::vector<pollfd> waiting(ports_.size());
    while (!stop_) {
        for (std::size_t i = 0; i < ports_.size(); ++i) {
            waiting[i] = {ports_[i].socket->fd(), POLLIN, 0};
        }
        ::poll(waiting.data(), waiting.size(), kLookForStopMs);
        for (std::size_t i = 0; i < ports_.size(); ++i) {
            for (std::size_t n = 0; (n = ports_[i].socket->receive(batch)) > 0;) {
                for (std::size_t k = 0; k < n; ++k) {
                    if (auto* reader = reader_for(i, iec61850::ethertype_of(batch[k].octets))) {
                        reader->push(std::as_bytes(batch[k].octets), batch[k].stamp_ns, static_cast<std::uint32_t>(i));
                    }
                }
            }
        }
    }
}

Result<void> FrameCapture::write_due() {
    std::vector<bus::WireFrame const*> due;
    for (auto const& [channel, reader] : readers_) {
        auto const frames = reader->take();
        due.insert(due.end(), frames.begin(), frames.end());
    }
    bool const lockstep = node_.lockstep();
    std::sort(due.begin(), due.end(), [&](bus::WireFrame const* a, bus::WireFrame const* b) {
        return lockstep ? std::tie(a->time, a->port, a->octets) < std::tie(b->time, b->port, b->octets) : a->kernel_ns < b->kernel_ns;
    });
    std::int64_t const epoch_ns = node_.config().clock.epoch_unix_s * 1'000'000'000;
    for (bus::WireFrame const* frame : due) {
        std::span<std::uint8_t const> const octets{reinterpret_cast<std::uint8_t const*>(frame->octets.data()), frame->octets.size()};
        std::int64_t const stamp = lockstep ? epoch_ns + node_.time_base().nanoseconds(frame->time) : frame->kernel_ns;
        std::string const comment = lockstep ? "" : fmt::format("simulated time {:.6f} s", node_.time_base().seconds(frame->time));
        if (auto ok = file_->write(ports_[frame->port].interface, stamp, octets, comment); !ok) {
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
        // In lockstep nothing is lost (a ledger would miss it), and the kernel's counts include what came after the end.
        if (!node_.lockstep()) {
            if (auto ok = file_->statistics(port.interface, 0, counters.received, counters.dropped); !ok) {
                return ok;
            }
        }
    }
    return file_->close();
}

} // namespace gridspace::recorder
