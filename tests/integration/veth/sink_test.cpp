// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Streams of sampled values that a gateway sends in real time, on a cable and without a run around it.
#include "bus/topics.hpp"
#include "common/config/yaml.hpp"
#include "common/source_tree.hpp"
#include "gateways/gateway/sample_pacer.hpp"
#include "gateways/iec61850/sv.hpp"
#include "veth.hpp"

#include <cstdlib>

namespace gridspace::gateways {
namespace {

constexpr char const* kHeld = R"(
streams:
  SV: {kind: smv, mac: "01:0C:CD:04:00:03", app_id: 0x4003, sv_id: MU03, data_set: {Ia: int32}, send_refr_tm: true,
       authentication: {key_name: bus, required: true}}
mappings:
  m: {to: {stream: SV}, fields: {Ia: {value: 7}}}
)";
constexpr char const* kIndexed = R"(
streams:
  SV: {kind: smv, mac: "01:0C:CD:04:00:03", app_id: 0x4003, sv_id: MU03, data_set: {Ia: int32}, send_refr_tm: true,
       authentication: {key_name: bus, required: true}}
mappings:
  m: {from: {topic: t, type: LineCurrents}, each: samples, index: first_index, to: {stream: SV}, fields: {Ia: {value: 7}}}
)";

class RealTimeSinks : public ethernet::Veth {
  protected:
    /// The only route of `text`, and a bus of its own: with a simulator that never comes, or without any.
    void open(std::string const& text, std::string const& simulator) {
        config::Diagnostics diagnostics;
        auto const root = config::parse_yaml(text, config::make_source("gw.yaml", text), diagnostics);
        ASSERT_TRUE(root) << diagnostics.render();
        wire_.interface = "left";
        wire_.streams = streams::read_streams(*root->find("streams"), diagnostics);
        config::Node table = config::Node::map();
        table.set("mappings", *root->find("mappings"));
        config::read_fields(table, "", diagnostics, [&](config::Fields& f) { describe(f, config_); });
        ASSERT_TRUE(diagnostics.ok()) << diagnostics.render();
        routes_ = make_routes(config_, wire_.streams, bus::idl_of_type, diagnostics);
        ASSERT_EQ(routes_.size(), 1U) << diagnostics.render();

        bus::NodeConfig alone;
        alone.process = "a";
        alone.program = "test";
        alone.qos = source_tree("qos/gateway.xml");
        alone.management = {1, {"127.0.0.1"}};
        alone.clock.mode = bus::ClockMode::realtime;
        alone.clock.simulator = simulator;
        auto node = bus::Node::create(alone);
        ASSERT_TRUE(node) << describe(node.error());
        node_ = std::move(*node);
        auto port = WirePort::open(*node_, wire_, {{iec61850::kSvEthertype}, {}});
        ASSERT_TRUE(port) << describe(port.error());
        port_ = std::move(*port);
        context_.emplace(GatewayContext{*node_, *port_, wire_, WireClock{*node_}, SimSpan{}});
    }
    void TearDown() override {
        context_.reset();
        port_.reset();
        node_.reset();
        Veth::TearDown();
    }

    static ethernet::Port right() {
        ethernet::PortOptions options{.interface = "right", .filter = {}};
        options.filter.ethertypes = {iec61850::kSvEthertype};
        return std::move(*ethernet::Port::open(options));
    }
    /// How many of the first twenty frames have a code that is genuine.
    int genuine(ethernet::Port& port) {
        auto const theirs = std::move(*FrameAuthentication::create(wire_.streams, std::nullopt));
        int out = 0;
        std::vector<ethernet::ReceivedFrame> batch(8);
        for (int came = 0; came < 20;) {
            std::size_t const n = port.receive(batch);
            for (std::size_t i = 0; i < n; ++i, ++came) {
                out += theirs->accept(batch[i].octets, ArrivalClock::read().utc_ns, {}) ? 1 : 0;
            }
            if (n == 0 && !port.wait(2'000'000'000)) {
                break;
            }
        }
        return out;
    }

    WireConfig wire_;
    GatewayConfig config_;
    std::vector<Route> routes_;
    std::unique_ptr<bus::Node> node_;
    std::unique_ptr<WirePort> port_;
    std::optional<GatewayContext> context_;
};

TEST_F(RealTimeSinks, SendHeldSamplesWithACode) {
    open(kHeld, "");
    auto receiver = right();
    auto sink = ZeroOrderHoldSink::create(*context_, routes_.front());
    ASSERT_TRUE(sink);
    auto pacer = SamplePacer::create(wire_, *port_, {sink->get()});
    ASSERT_TRUE(pacer);
    (*sink)->start({});
    (*pacer)->start(0);
    EXPECT_GE(genuine(receiver), 20);
}

TEST_F(RealTimeSinks, SendIndexedSamplesWithACode) {
    open(kIndexed, "");
    auto receiver = right();
    auto sink = IndexedSink::create(*context_, routes_.front());
    ASSERT_TRUE(sink);
    for (std::int64_t i = 0; i < 40; ++i) {
        (*sink)->put({}, i);
    }
    EXPECT_GE(genuine(receiver), 20);
}

TEST_F(RealTimeSinks, StampWithTheClockOfTheMachineUntilTheSimulatorsIsKnown) {
    open(kHeld, "sim");
    auto sink = ZeroOrderHoldSink::create(*context_, routes_.front());
    ASSERT_TRUE(sink);
    (*sink)->start({});
    std::int64_t const now = ArrivalClock::read().utc_ns;
    iec61850::SvFrame frame;
    ASSERT_TRUE(iec61850::decode_sv((*sink)->sample_now(0), frame));
    EXPECT_LT(std::llabs(frame.view()[0].refr_tm.nanoseconds() - now), 1'000'000'000) << "not 1970";
}

} // namespace
} // namespace gridspace::gateways
