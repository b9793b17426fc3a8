// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What leaves from a thread that sends beside its process's port, as paced samples do.
#include "gateways/port/arrival_clock.hpp"
#include "gateways/port/frame_sender.hpp"
#include "veth.hpp"

namespace gridspace::gateways {
namespace {

streams::Stream stream(std::string const& name, std::uint16_t app_id) {
    streams::Stream out;
    out.name.name = out.sv_id = name;
    out.address.destination = *iec61850::Mac::parse("01:0C:CD:04:00:21");
    out.address.app_id = app_id;
    out.address.vlan = iec61850::VlanTag{};
    out.data_set = iec61850::data_set_92le();
    return out;
}

class FrameSenders : public ethernet::Veth {
  protected:
    static std::vector<std::vector<std::uint8_t>> receive(ethernet::Port& port, std::size_t count) {
        std::vector<std::vector<std::uint8_t>> out;
        std::vector<ethernet::ReceivedFrame> batch(8);
        while (out.size() < count) {
            std::size_t const n = port.receive(batch);
            for (std::size_t i = 0; i < n; ++i) {
                out.emplace_back(batch[i].octets.begin(), batch[i].octets.end());
            }
            if (n == 0 && !port.wait(2'000'000'000)) {
                break;
            }
        }
        return out;
    }
};

TEST_F(FrameSenders, SignWhatIsOfAnAuthenticatedStream) {
    WireConfig wire;
    wire.interface = "left";
    wire.streams = {stream("A", 0x4001), stream("B", 0x4002)};
    wire.streams[0].authentication.emplace();
    wire.streams[0].authentication->key_name = "bus";
    wire.streams[0].authentication->required = true;
    auto const ours = std::move(*FrameAuthentication::create(wire.streams, std::nullopt));
    auto const theirs = std::move(*FrameAuthentication::create(wire.streams, std::nullopt));
    std::atomic<std::uint16_t> sequence{0};
    auto sut = FrameSender::open(wire, sequence, ours.get());
    ASSERT_TRUE(sut) << describe(sut.error());
    ethernet::PortOptions options{.interface = "right", .filter = {}};
    options.filter.ethertypes = {iec61850::kSvEthertype};
    auto right = ethernet::Port::open(options);
    ASSERT_TRUE(right) << describe(right.error());
    iec61850::Mac const from{{2, 0, 0, 0, 0, 1}};
    auto const a = *wire.streams[0].sv_template(from), b = *wire.streams[1].sv_template(from);

    std::array<iec61850::Octets, 3> const frames{a.frame(), b.frame(), a.frame()};
    sut->send(frames);

    auto const came = receive(*right, frames.size());
    ASSERT_EQ(came.size(), frames.size());
    EXPECT_EQ(came[1], std::vector<std::uint8_t>(b.frame().begin(), b.frame().end()));
    for (std::size_t const i : {0U, 2U}) {
        EXPECT_TRUE(theirs->accept(came[i], ArrivalClock::read().utc_ns, {})) << i;
    }
}

} // namespace
} // namespace gridspace::gateways
