// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/wire.hpp"
#include "gateways/ethernet/port.hpp"
#include "recorder/app/recorder_config.hpp"
#include "recorder/pcapng/pcapng_writer.hpp"

#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <thread>
#include <vector>

namespace gridspace::recorder {

/// Every frame of the given ports into one capture file. In lockstep the stamps are simulated times and the order is
/// that of (time, port, octets), so that two runs give the same file; in real time the stamps are the kernel's, and the
/// comment of a frame says the simulated time. A port is the switch's end of a host's cable, where a frame is seen
/// once, when it was sent; or a place of its own (the host's side of who sits in its cable, a real interface), where
/// both ways are seen.
class FrameCapture {
  public:
    /// Before Node::start. Nothing is captured without ports.
    [[nodiscard]] static Result<std::unique_ptr<FrameCapture>> open(bus::Node& node, CaptureConfig const& config);
    ~FrameCapture();

    void take_due();                          ///< frames whose time has come
    [[nodiscard]] Result<void> write_taken(); ///< those of the last take_due()
    [[nodiscard]] Result<void> close();
    /// Real time, after close(): frames that the kernel could not keep for us, or that waited too long for the disk.
    [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
    /// Lockstep, after close(): "31 frames that are neither SMV, GOOSE nor IP at 'process_bus_mu21': 31 from ...".
    [[nodiscard]] std::vector<std::string> strangers() const;

  private:
    explicit FrameCapture(bus::Node& node) : node_{node} {}
    Result<void> open_ports(CaptureConfig const& config);
    void capture(); ///< real time: until stop_
    void fetch();

    /// One ethertype on one piece of cable; 0: any ethertype.
    using Channel = std::pair<std::string, std::uint16_t>;
    /// Who takes frames of one way through a port; null: they are not captured.
    struct Way {
        bus::WireReader *smv{nullptr}, *goose{nullptr}, *ip{nullptr}, *other{nullptr};
        [[nodiscard]] bus::WireReader* reader_of(iec61850::Octets frame) const;
    };
    struct Port {
        std::unique_ptr<ethernet::Port> socket;
        std::uint32_t interface{0}; ///< in the file
        bool both_ways{false};
        Way in, out;
        std::string name;
        lockstep::ForeignFrames others; ///< lockstep: neither SMV nor GOOSE nor IP; of the capturing thread as well
        std::uint64_t no_room{0};       ///< frames that found none; of the capturing thread until it has ended
    };
    Way way_of(std::string const& link);
    bus::WireReader* reader_of(Channel const& channel);

    bus::Node& node_;
    std::unique_ptr<pcapng::Writer> file_;
    std::vector<Port> ports_;
    std::map<Channel, std::unique_ptr<bus::WireReader>> readers_;
    std::array<ethernet::ReceivedFrame, 64> batch_; ///< of who fetches
    std::vector<bus::WireFrame const*> due_;
    std::uint64_t dropped_{0};
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

} // namespace gridspace::recorder
