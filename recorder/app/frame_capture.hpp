// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/wire.hpp"
#include "gateways/ethernet/port.hpp"
#include "recorder/app/recorder_config.hpp"
#include "recorder/pcapng/pcapng_writer.hpp"

#include <atomic>
#include <map>
#include <memory>
#include <thread>
#include <vector>

namespace gridspace::recorder {

/// Every frame of the given ports into one capture file. In lockstep the stamps are simulated times and the order is that of
/// (time, port, octets), so that two runs give the same file; in real time the stamps are the kernel's, and the comment of a
/// frame says the simulated time. A port is the switch's end of a host's cable: a frame is seen once, where it was sent.
class FrameCapture {
  public:
    /// Before Node::start. Nothing is captured without ports.
    [[nodiscard]] static Result<std::unique_ptr<FrameCapture>> open(bus::Node& node, CaptureConfig const& config);
    ~FrameCapture();

    [[nodiscard]] Result<void> write_due();
    [[nodiscard]] Result<void> close();

  private:
    explicit FrameCapture(bus::Node& node) : node_{node} {}
    Result<void> open_ports(CaptureConfig const& config);
    void capture();
    bus::WireReader* reader_for(std::size_t port, std::uint16_t ethertype);

    struct Port {
        std::string link;
        std::unique_ptr<ethernet::Port> socket;
        std::uint32_t interface{0}; ///< in the file
    };

    bus::Node& node_;
    std::unique_ptr<pcapng::Writer> file_;
    std::vector<Port> ports_;
    std::map<std::pair<std::string, std::uint16_t>, std::unique_ptr<bus::WireReader>> readers_; ///< 0: any other ethertype
    std::atomic<bool> stop_{false};
    std::thread thread_;
};

} // namespace gridspace::recorder
