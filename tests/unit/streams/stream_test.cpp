// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/streams/stream.hpp"

#include "common/config/merge.hpp"
#include "common/config/yaml.hpp"
#include "gateways/port/subscriptions.hpp"

#include <gmock/gmock.h>

namespace gridspace::streams {
namespace {

using testing::AllOf;
using testing::HasSubstr;

struct Read {
    std::vector<Stream> streams;
    std::string text; ///< diagnostics; empty when nothing is wrong
};

Read read(std::string const& yaml) {
    config::Diagnostics diagnostics;
    auto node = config::parse_yaml(yaml, config::make_source("streams.yaml", yaml), diagnostics);
    Read out;
    if (node) {
        config::resolve_likes(*node, diagnostics);
        out.streams = read_streams(*node, diagnostics);
    }
    out.text = diagnostics.errors() > 0 ? diagnostics.render() : "";
    return out;
}

std::string const kSmv =
    "S: {kind: smv, mac: \"01:0C:CD:04:00:21\", app_id: 0x4021, sv_id: MU21, data_set: {Ia: float32}}\n";
std::string const kGoose = "G: {kind: goose, mac: \"01:0C:CD:01:00:02\", app_id: 0x8002, control_block: "
                           "IED2LD0/LLN0$GO$Trip, data_set: {status: boolean}}\n";

/// One stream with `what` replaced by `with`.
std::string changed(std::string text, std::string const& what, std::string const& with) {
    std::size_t const at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return text.replace(at, what.size(), with);
}

TEST(Streams, AreReadWithTheirDefaults) {
    auto const sut = read(kSmv + kGoose);
    ASSERT_EQ(sut.text, "");
    Stream const& smv = sut.streams.at(0);
    EXPECT_EQ(smv.address.app_id, 0x4021);
    EXPECT_EQ(smv.address.vlan, (iec61850::VlanTag{0, 4, false}));
    EXPECT_EQ(smv.rate_hz, Rational{4800});
    EXPECT_EQ(smv.smp_synch, iec61850::kGlobalClock);
    EXPECT_EQ(smv.sv_template({})->frame().size(), 60U);
    Stream const& goose = sut.streams.at(1);
    EXPECT_EQ(goose.data_set_name, "IED2LD0/LLN0$G");
    EXPECT_EQ(goose.timing.growth, 2);
    EXPECT_TRUE(goose.goose_template({}));
}

TEST(Streams, SaySmpRateOnlyWhereItCanHoldTheRate) {
    std::string const with_rate = changed(kSmv, "sv_id: MU21", "sv_id: MU21, send_smp_rate: true, rate_hz: 65536");
    EXPECT_THAT(read(with_rate).text,
                AllOf(HasSubstr("smpRate cannot say 65536 samples a second"), HasSubstr("65535")));
    EXPECT_EQ(read(changed(with_rate, "65536", "65535")).text, "");
    EXPECT_EQ(read(changed(with_rate, "send_smp_rate: true, ", "")).text, "");
}

TEST(Streams, TakeTheRestFromAStreamThatTheyAreLike) {
    auto const sut = read(kSmv + "T: {like: S, mac: \"01:0C:CD:04:00:22\", sv_id: MU22}\n");
    ASSERT_EQ(sut.text, "");
    EXPECT_EQ(sut.streams.at(1).sv_id, "MU22");
    EXPECT_EQ(sut.streams.at(1).address.app_id, 0x4021);
}

TEST(Streams, MayHoldStructuresArraysAndTextsOfALength) {
    auto const sut = read(changed(kGoose, "{status: boolean}",
                                  "{pos: {stVal: position, q: quality}, h: {array: float32, count: 3}, l: [int8, {a: "
                                  "uint8}], id: {type: visible_string, length: 65}}"));
    ASSERT_EQ(sut.text, "");
    std::vector<std::string> names;
    for (auto const& leaf : leaves_of(sut.streams[0].data_set)) {
        names.push_back(leaf.name);
    }
    EXPECT_THAT(names, testing::ElementsAre("pos.stVal", "pos.q", "h.0", "h.1", "h.2", "l.0", "l.1.a", "id"));
    EXPECT_EQ(leaves_of(sut.streams[0].data_set).back().length, 65);
}

TEST(Streams, KnowTheDataSetOf92LE) {
    auto const sut = read(changed(kSmv, "{Ia: float32}", "9-2LE"));
    ASSERT_EQ(sut.text, "");
    EXPECT_EQ(iec61850::SvLayout{sut.streams[0].data_set}.sample_octets(), 64U);
}

TEST(Streams, CarryWhatTheClockIs) {
    auto const sut = read(changed(kSmv, "sv_id", "clock_identity: 17, gm_identity: \"001122FFFE334455\", sv_id"));
    ASSERT_EQ(sut.text, "");
    EXPECT_EQ(sut.streams[0].smp_synch, 17);
    EXPECT_EQ(sut.streams[0].gm_identity, 0x001122FFFE334455U);
}

TEST(Streams, MayNameControlBlocksOfOtherMakersAndLiveAsLongAsTheFrameCanSay) {
    EXPECT_EQ(read(changed(kGoose, "IED2LD0/LLN0$GO$Trip", "AA1J1Q01A1LD0/PRPTRC1$GO$a-b.c")).text, "");
    EXPECT_EQ(read(changed(kGoose, "data_set", "max_time_ms: 1431655765, data_set")).text, "");
    EXPECT_EQ(read(changed(kGoose, "data_set", "live_factor: 1.01, data_set")).text, "");
}

struct Mistake {
    char const *name, *what, *with, *message;
    bool goose;
};
void PrintTo(Mistake const& m, std::ostream* out) {
    *out << m.name;
}

class StreamMistake : public testing::TestWithParam<Mistake> {};
INSTANTIATE_TEST_SUITE_P(
    Is, StreamMistake,
    testing::Values(
        Mistake{"UnknownKey", "sv_id", "sv_idd: x, sv_id", "did you mean 'sv_id'?", false},
        Mistake{"NoAddress", "mac: \"01:0C:CD:04:00:21\", ", "", "mac", false},
        Mistake{"ShortAddress", "01:0C:CD:04:00:21", "01:0C:CD:04", "'01:0C:CD:04' is not an Ethernet address", false},
        Mistake{"AddressOfOne", "01:0C:CD:04:00:21", "00:0C:CD:04:00:21", "is the address of one station", false},
        Mistake{"AppId", "0x4021", "0x14021", "65535", false},
        Mistake{"Type", "float32", "flaot32", "did you mean 'float32'?", false},
        Mistake{"EmptyDataSet", "{Ia: float32}", "{}", "the data set is", false},
        Mistake{"NoDataSet", ", data_set: {Ia: float32}", "", "data_set", false},
        Mistake{"Rate", "sv_id", "rate_hz: 4800.5, sv_id", "samples a second", false},
        Mistake{"SamplesPerFrame", "sv_id", "samples_per_frame: 17, sv_id", "16", false},
        Mistake{"TooLong", "{Ia: float32}", "{a: {array: visible_string, count: 43}}", "octets behind the ethertype",
                false},
        Mistake{"ClockIdentity", "sv_id", "clock_identity: 3, sv_id", "5", false},
        Mistake{"GrandMaster", "sv_id", "gm_identity: \"xyz\", sv_id", "is not the identity of a clock", false},
        Mistake{"ArrayCount", "{Ia: float32}", "{a: {array: int8, count: 0}}", "a whole `count`", false},
        Mistake{"NoKey", "sv_id", "authentication: {required: true}, sv_id", "expected one of key_file and key_name",
                false},
        Mistake{"TwoKeys", "sv_id", "authentication: {key_file: a, key_name: b}, sv_id", "which key?", false},
        Mistake{"Algorithm", "sv_id", "authentication: {key_name: b, algorithm: md5}, sv_id", "md5", false},
        Mistake{"NoRoomForACode", ", data_set: {Ia: float32}",
                ", authentication: {key_name: b}, data_set: {a: {array: visible_string, count: 41}}",
                "there is no room for a code", false},
        Mistake{"GooseKeyInSmv", "sv_id", "max_time_ms: 10, sv_id", "max_time_ms", false},
        Mistake{"Times", "data_set", "min_time_ms: 20, max_time_ms: 10, data_set", "it is shorter than min_time_ms",
                true},
        Mistake{"Growth", "data_set", "growth: 0.5, data_set", "growth", true},
        Mistake{"LongReference", "IED2LD0/LLN0$GO$Trip",
                "IED2LD0/"
                "LLN0$GO$"
                "TripTripTripTripTripTripTripTripTripTripTripTripTripTripTripTripTripTripTripTripTripTripTripTripTripTr"
                "ipTripTripTripTripTripTripTripTr"
                "ipTripTrip",
                "gocbRef has", true},
        Mistake{"ControlBlockOfOnePart", "IED2LD0/LLN0$GO$Trip", "x", "'x' is no reference of a control block", true},
        Mistake{"ControlBlockWithSpaces", "IED2LD0/LLN0$GO$Trip", "no / slash", "LD/LLN0$GO$name without spaces", true},
        Mistake{"ControlBlockOfNoDevice", "IED2LD0/LLN0$GO$Trip", "/LLN0$GO$Trip", "is no reference", true},
        Mistake{"LiveFactor", "data_set", "live_factor: 1, data_set", "live_factor", true},
        Mistake{"LiveMin", "data_set", "live_min_ms: 5000000000, data_set", "4294967295", true},
        Mistake{"TimeAllowedToLive", "data_set", "max_time_ms: 1500000000, data_set",
                "timeAllowedToLive would be 4500000000 ms: live_factor (3) times max_time_ms (1500000000)", true},
        Mistake{"NoControlBlock", "control_block: IED2LD0/LLN0$GO$Trip, ", "", "control_block", true},
        Mistake{"92LEInGoose", "{status: boolean}", "9-2LE", "the data set is '9-2LE'", true}),
    [](auto const& p) { return p.param.name; });

TEST_P(StreamMistake, IsExplainedAtItsPlace) {
    auto const sut = read(changed(GetParam().goose ? kGoose : kSmv, GetParam().what, GetParam().with));
    EXPECT_THAT(sut.text, AllOf(HasSubstr("streams.yaml:1:"), HasSubstr(GetParam().message)));
}

TEST(Streams, TellWhoPublishesThemHowToBegin) {
    auto const of = [](std::string const& keys) {
        return gateways::goose_publisher_params(read(changed(kGoose, "data_set", keys + "data_set")).streams.at(0));
    };
    EXPECT_EQ(of("").first_sq_num, 0U);
    auto const sut = of("first_sq_num: 1, simulated: true, min_time_ms: 3, ");
    EXPECT_EQ(sut.first_sq_num, 1U);
    EXPECT_TRUE(sut.simulation);
    EXPECT_EQ(sut.timing.min_ns, 3'000'000);
}

TEST(Streams, ThatCannotBeToldApartAreRefused) {
    EXPECT_THAT(read(kSmv + "T: {like: S}\n").text,
                AllOf(HasSubstr("streams.yaml:2:"), HasSubstr("'S' and 'T' cannot be told apart")));
    EXPECT_EQ(read(kSmv + "T: {like: S, sv_id: MU22}\n").text, "");
}

TEST(Streams, ThatAreAuthenticatedHaveAnAddressOfTheirOwn) {
    std::string const key = "authentication: {key_name: k}";
    EXPECT_EQ(read(changed(kSmv, "sv_id", key + ", sv_id")).text, "");
    EXPECT_THAT(read(kSmv + "T: {like: S, sv_id: MU22, " + key + "}\n").text,
                HasSubstr("streams 'S' and 'T' have the same Ethernet address and app_id"));
    EXPECT_EQ(read(kSmv + "T: {like: S, sv_id: MU22, app_id: 0x4022, " + key + "}\n").text, "");
}

std::string over_udp(std::string const& stream, std::string const& keys) {
    std::string const mac = "mac: \"";
    std::size_t const from = stream.find(mac);
    return stream.substr(0, from) + "udp: {" + keys + "}" + stream.substr(stream.find('"', from + mac.size()) + 1);
}

TEST(Streams, OverUdpGoToTheEthernetAddressOfTheirGroup) {
    Read const read_ones = read(over_udp(kGoose, "group: 239.192.1.2, source: 10.1.2.3, ttl: 3, dscp: 10"));
    ASSERT_EQ(read_ones.text, "");
    Stream const& sut = read_ones.streams.at(0);
    EXPECT_EQ(sut.address.destination.to_string(), "01:00:5E:40:01:02");
    iec61850::RoutableAddress const address = sut.udp->from({1, 1, 1, 1}, std::nullopt);
    EXPECT_EQ(address.ip_source, (iec61850::Ipv4{10, 1, 2, 3}));
    EXPECT_EQ(address.ttl, 3);
    EXPECT_EQ(address.dscp, 10);
    auto const own = read(over_udp(kGoose, "group: 239.192.1.2")).streams.at(0).udp->from({1, 1, 1, 1}, std::nullopt);
    EXPECT_EQ(own.ip_source, (iec61850::Ipv4{1, 1, 1, 1}));
}

TEST(Streams, OverUdpHaveAGroupARoomAndNoOtherAddress) {
    for (auto const& [stream, says] : std::vector<std::pair<std::string, char const*>>{
             {over_udp(kGoose, "group: 10.0.0.1"), "routers forward nothing"},
             {over_udp(kGoose, "group: 224.0.0.7"), "routers forward nothing"},
             {over_udp(kGoose, "group: 239.1.1"), "'239.1.1' is not an IPv4 address"},
             {over_udp(kGoose, "ttl: 3"), "group"},
             {over_udp(kGoose, "group: 239.1.1.1, source: here"), "'here' is not an IPv4 address"},
             {over_udp(kGoose, "group: 239.1.1.1, ttl: 0"), "ttl"},
             {changed(kGoose, "mac", "udp: {group: 239.1.1.1}, mac"), "the stream has `udp` and `mac`"},
             {changed(over_udp(kGoose, "group: 239.1.1.1"), "data_set", "authentication: {key_name: k}, data_set"),
              "goes over UDP"},
             {over_udp(kGoose, "group: 239.1.1.1") +
                  changed(changed(over_udp(kGoose, "group: 238.1.1.1"), "Trip", "Other"), "G:", "H:"),
              "the same Ethernet address and app_id"}}) {
        EXPECT_THAT(read(stream).text, HasSubstr(says)) << stream;
    }
    // 1435 octets of an APDU: 25 before the samples of each ASDU here, so what fits in a frame need not in a datagram.
    auto const samples = [](int n) {
        std::string members;
        for (int i = 0; i < n; ++i) {
            members += (i == 0 ? "" : ", ") + ("m" + std::to_string(i)) + ": float32";
        }
        return "L: {kind: smv, udp: {group: 239.1.1.1}, sv_id: MU, data_set: {" + members + "}}\n";
    };
    EXPECT_EQ(read(samples(340)).text, "");
    EXPECT_THAT(read(samples(362)).text, HasSubstr("a datagram has room for 1435"));
}

TEST(Streams, ReportAllMistakesAtOnce) {
    std::string const text = read(changed(kSmv, "MU21", "[1]") + changed(kGoose, "0x8002", "x")).text;
    EXPECT_THAT(text, AllOf(HasSubstr("streams.yaml:1:"), HasSubstr("streams.yaml:2:"), HasSubstr("2 errors")));
}

} // namespace
} // namespace gridspace::streams
