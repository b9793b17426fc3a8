// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Wireshark as the judge: every frame that we write decodes there without a malformed or expert item, with the values
// we meant.
#include "gateways/iec61850/authentication.hpp"
#include "gateways/iec61850/goose_publisher.hpp"
#include "gateways/iec61850/routable.hpp"
#include "gateways/iec61850/sv_layout.hpp"
#include "gateways/iec61850/sv_template.hpp"
#include "recorder/pcapng/pcapng_writer.hpp"

#include <cstdlib>
#include <filesystem>
#include <gmock/gmock.h>
#include <sys/wait.h>

namespace gridspace::iec61850 {
namespace {

using testing::HasSubstr;

class Tshark : public testing::Test {
  protected:
    void SetUp() override {
        if (std::system("tshark --version >/dev/null 2>&1") != 0) {
            GTEST_SKIP() << "tshark is not installed";
        }
        std::string pattern = testing::TempDir() + "/gridspace-tshark-XXXXXX";
        folder_ = ::mkdtemp(pattern.data());
        auto writer = pcapng::Writer::create(file(), "gridspace test");
        ASSERT_TRUE(writer);
        writer_.emplace(std::move(*writer));
        interface_ = writer_->add_interface("process_bus");
    }
    void TearDown() override {
        if (!folder_.empty()) {
            std::filesystem::remove_all(folder_);
        }
    }

    void capture(Octets frame, std::string_view comment = {}) {
        ASSERT_TRUE(writer_->write(interface_, 1'575'158'405'123'456'789 + time_++, frame, comment));
    }

    /// What tshark prints for the captured frames.
    [[nodiscard]] std::string print(std::string const& arguments) {
        EXPECT_TRUE(writer_->flush());
        std::string const command =
            "tshark -n -r " + file().string() + " " + preference_ + " " + arguments + " 2>/dev/null";
        std::string out;
        FILE* const pipe = ::popen(command.c_str(), "r");
        char buffer[4096];
        for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) {
            out.append(buffer, n);
        }
        EXPECT_EQ(::pclose(pipe), 0) << command;
        return out;
    }
    [[nodiscard]] std::string fields(std::string const& names) {
        std::string arguments = "-T fields -E separator=' ' -E aggregator=,";
        std::string name;
        for (char const c : names + " ") {
            if (c == ' ') {
                arguments += " -e " + name;
                name.clear();
            } else {
                name += c;
            }
        }
        return print(arguments);
    }
    // A comment is an expert item too, below severity "chat".
    void expect_nothing_wrong() { EXPECT_EQ(print("-Y '_ws.malformed || _ws.expert.severity >= 0x200000' -V"), ""); }

    [[nodiscard]] std::filesystem::path file() const { return folder_ / "frames.pcapng"; }

    static Address address() {
        return {*Mac::parse("01:0C:CD:04:00:21"), *Mac::parse("02:00:00:00:00:01"), VlanTag{100, 4, false}, 0x4021,
                false};
    }
    static AsduDescription asdu(std::string sv_id, std::size_t octets) {
        AsduDescription out;
        out.sv_id = std::move(sv_id);
        out.sample_octets = octets;
        return out;
    }

    std::string preference_;

  private:
    std::filesystem::path folder_;
    std::optional<pcapng::Writer> writer_;
    std::uint32_t interface_{0};
    std::int64_t time_{0};
};

TEST_F(Tshark, ReadsThreeCurrents) {
    auto frame = SvTemplate::create(address(), {asdu("GS_TL2_MU21", 12)});
    frame->set_smp_cnt(0, 4799);
    store_float(frame->sample(0), 0, 1.0F);
    capture(frame->frame(), "simulated 0.999791667 s");
    expect_nothing_wrong();
    EXPECT_EQ(
        fields("vlan.id vlan.priority sv.appid sv.svID sv.smpCnt sv.confRev sv.smpSynch sv.seqData frame.time_epoch"),
        "100 4 0x4021 GS_TL2_MU21 4799 1 2 3f8000000000000000000000 1575158405.123456789\n");
    EXPECT_THAT(print("-V"), testing::AllOf(HasSubstr("simulated 0.999791667 s"), HasSubstr("(process_bus)")));
}

TEST_F(Tshark, ReadsTheValuesAndQualitiesOf92LE) {
    preference_ = "-o sv.decode_data_as_phsmeas:TRUE";
    SvLayout const layout{data_set_92le()};
    auto frame = SvTemplate::create(address(), {asdu("xxxxMUnn01", 64)});
    for (std::size_t i = 0; i < 8; ++i) {
        layout.write(2 * i, Value::integer(BasicType::int32, 1000 * static_cast<std::int64_t>(i) - 3000),
                     frame->sample(0));
    }
    layout.write(1, Value::quality(0x2), frame->sample(0));
    layout.write(3, Value::quality(0x800), frame->sample(0));
    capture(frame->frame());
    expect_nothing_wrong();
    EXPECT_EQ(fields("sv.meas_value sv.meas_quality"),
              "-3000,-2000,-1000,0,1000,2000,3000,4000 "
              "0x00000002,0x00000800,0x00000000,0x00000000,0x00000000,0x00000000,0x00000000,0x00000000\n");
}

/// The APDU of a GOOSE message of one Boolean.
std::vector<std::uint8_t> goose_apdu(Address const& address) {
    GooseDescription description;
    description.gocb_ref = "IED2LD0/LLN0$GO$Trip";
    description.dat_set = "IED2LD0/LLN0$TripSet";
    description.conf_rev = 7;
    description.data_set = {{DataNode::leaf("trip", BasicType::boolean)}};
    GoosePublisher publisher{*GooseTemplate::create(address, description), 7, {}};
    publisher.start(0, 1'575'158'405'000'000'000);
    FrameHeader header;
    EXPECT_TRUE(decode_header(publisher.take(0), header));
    return {header.apdu.begin(), header.apdu.end()};
}

TEST_F(Tshark, ReadsAnAuthenticatedFrameAsBeforeAndShowsItsCodeBehindIt) {
    KeyEntry key;
    key.id = 7;
    key.secret.assign(16, 0x5A);
    KeyRing keys = std::move(*KeyRing::create(code_kind(CodeAlgorithm::aes_gmac_128), {key}));
    FrameSigner signer{CodeAlgorithm::aes_gmac_128};
    std::uint64_t counter = 0;
    auto frame = SvTemplate::create(address(), {asdu("GS_TL2_MU21", 12)});
    frame->set_smp_cnt(0, 17);
    store_float(frame->sample(0), 0, 1.0F);
    capture(frame->frame());
    capture(signer.sign(frame->frame(), keys, 1'575'158'405'000'000'000, counter));
    expect_nothing_wrong();
    std::string const same = "GS_TL2_MU21 17 3f8000000000000000000000";
    std::string const lines = fields("sv.svID sv.smpCnt sv.seqData frame.len");
    std::size_t const octets = frame->frame().size();
    EXPECT_EQ(lines, same + " " + std::to_string(octets) + "\n" + same + " " +
                         std::to_string(octets + extension_octets(CodeAlgorithm::aes_gmac_128)) + "\n");
    EXPECT_THAT(print("-V -Y 'frame.number == 2'"), HasSubstr("Trailer: 85"));
    EXPECT_THAT(print("-V -Y 'frame.number == 1'"), testing::Not(HasSubstr("Trailer")));
}

TEST_F(Tshark, ReadsGooseOverUdp) {
    auto const apdu = goose_apdu(address());
    SessionHeader session;
    session.spdu_number = 12;
    session.time_of_current_key = 1'575'158'400;
    session.time_to_next_key = 60;
    session.key_id = 3;
    RoutablePayload const one{true, false, 0x8021, apdu};
    RoutableAddress to;
    to.ip_destination = {239, 1, 1, 1};
    to.ip_source = {10, 0, 0, 1};
    to.destination = to.group();
    to.source = *Mac::parse("02:00:00:00:00:01");
    capture(udp_frame(to, encode_routable(session, {&one, 1})));
    preference_ = "-o ip.check_checksum:TRUE -o udp.check_checksum:TRUE";
    expect_nothing_wrong();
    EXPECT_EQ(
        fields("eth.dst ip.dst ip.checksum.status udp.checksum.status rgoose.spdu_id rgoose.spdu_num rgoose.version "
               "rgoose.curr_key_t rgoose.next_key_t rgoose.key_id rgoose.init_v_len rgoose.pdu_tag rgoose.simulation "
               "rgoose.appid goose.gocbRef goose.confRev goose.stNum"),
        "01:00:5e:01:01:01 239.1.1.1 1 1 0xa1 12 0x0002 0x5de30280 0x003c 0x00000003 0 0x81 0x00 0x8021 "
        "IED2LD0/LLN0$GO$Trip 7 1\n");
}

TEST_F(Tshark, SeesTwoMessagesInADatagramAndNoneInAnotherProtocol) {
    auto const apdu = goose_apdu(address());
    std::vector<RoutablePayload> const two{{true, false, 1, apdu}, {true, false, 2, apdu}};
    RoutableAddress to;
    to.ip_destination = {239, 1, 1, 1};
    to.destination = to.group();
    auto datagram = encode_routable({}, two);
    capture(udp_frame(to, datagram));
    expect_nothing_wrong();
    EXPECT_EQ(fields("rgoose.appid goose.confRev"), "0x0001,0x0002 7,7\n");
    datagram[2] = 0xA5; // no session of GOOSE
    capture(udp_frame(to, datagram));
    EXPECT_EQ(print("-Y rgoose.spdu_id -T fields -e frame.number"), "1\n");
}

TEST_F(Tshark, ReadsManySamplesStreamsAndOptionalFields) {
    AsduDescription full = asdu("MU1", 12);
    full.dat_set = "MU1LD0/LLN0$PhsMeas1";
    full.refr_tm = true;
    full.smp_rate = 4800;
    full.smp_mod = SampleMode::per_second;
    full.gm_identity = 0x001122FFFE334455;
    auto both = SvTemplate::create(address(), {full, asdu("MU2", 4)});
    both->set_refr_tm(0, UtcTime::from_nanoseconds(1'575'158'405'500'000'000, 0x0A));
    both->set_simulated(true);
    both->set_smp_synch(1, kLocalClock);
    capture(both->frame());
    auto sixteen = SvTemplate::create(address(), std::vector(16, asdu("MU3", 64)));
    for (std::size_t i = 0; i < 16; ++i) {
        sixteen->set_smp_cnt(i, static_cast<std::uint16_t>(i));
    }
    capture(sixteen->frame());
    expect_nothing_wrong();
    std::string ids = "MU3", synchs = "2";
    for (int i = 1; i < 16; ++i) {
        ids += ",MU3";
        synchs += ",2";
    }
    EXPECT_EQ(fields("sv.noASDU sv.svID sv.datSet sv.smpRate sv.smpMod sv.smpSynch sv.reserve1.s_bit"),
              "2 MU1,MU2 MU1LD0/LLN0$PhsMeas1 4800 1 2,1 1\n16 " + ids + "    " + synchs + " 0\n");
    EXPECT_THAT(fields("sv.smpCnt"), HasSubstr("\n0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15\n"));
    EXPECT_THAT(print("-V"),
                testing::AllOf(HasSubstr("Dec  1, 2019 00:00:05.5"), HasSubstr("gmIdentity: 0x001122fffe334455")));
}

TEST_F(Tshark, ReadsGooseDataOfEveryType) {
    for (IntegerForm const form : {IntegerForm::minimal, IntegerForm::fixed}) {
        GooseDescription description;
        description.gocb_ref = "IED2LD0/LLN0$GO$Trip";
        description.dat_set = "IED2LD0/LLN0$Trip";
        description.go_id = "TRIP2";
        description.integers = form;
        for (std::size_t i = 0; i < kBasicTypes; ++i) {
            auto const type = static_cast<BasicType>(i);
            description.data_set.members.push_back(DataNode::leaf(std::string{type_name(type)}, type));
        }
        description.data_set.members.push_back(
            {"pos",
             DataNode::Kind::structure,
             {},
             0,
             {DataNode::leaf("stVal", BasicType::position), DataNode::leaf("q", BasicType::quality)}});
        auto frame = GooseTemplate::create(address(), description);
        ASSERT_TRUE(frame) << describe(frame.error());
        frame->set(0, Value::of(true));
        frame->set(1, Value::integer(BasicType::int8, -100));
        frame->set(3, Value::integer(BasicType::int32, -70'000));
        frame->set(4, Value::integer(BasicType::int64, -5'000'000'000));
        frame->set(7, Value::integer(BasicType::uint32, 4'000'000'000));
        frame->set(9, Value::of(1.5F));
        frame->set(10, Value::of(-2.5));
        frame->set(15, Value::of(UtcTime::from_nanoseconds(1'575'158'405'500'000'000, 0x0A)));
        frame->set(17, Value::visible("hello"));
        GooseState state;
        state.st_num = 200;
        state.sq_num = 70'000;
        state.live_ms = 30;
        state.t = UtcTime::from_nanoseconds(1'575'158'405'500'000'000, 0x0A);
        capture(frame->frame(state));
        state.simulation = state.nds_com = true;
        capture(frame->frame(state));
    }
    expect_nothing_wrong();
    std::string const once = "IED2LD0/LLN0$Trip TRIP2 30 200 70000 1 20";
    EXPECT_EQ(fields("goose.datSet goose.goID goose.timeAllowedtoLive goose.stNum goose.sqNum goose.confRev "
                     "goose.numDatSetEntries"),
              once + "\n" + once + "\n" + once + "\n" + once + "\n");
    EXPECT_EQ(fields("goose.simulation goose.reserve1.s_bit goose.ndsCom"), "0 0 0\n1 1 1\n0 0 0\n1 1 1\n");
    std::string const text = print("-V"); // tshark prints the low 32 bits of an integer, as a signed one
    EXPECT_THAT(text, testing::AllOf(HasSubstr("boolean: True"), HasSubstr("integer: -100"),
                                     HasSubstr("integer: -70000"), HasSubstr("integer: -705032704"),
                                     HasSubstr("unsigned: -294967296"), HasSubstr("float value: 1.5"),
                                     HasSubstr("visible-string: hello"), HasSubstr("Dec  1, 2019 00:00:05.5")));
}

TEST_F(Tshark, FindsNothingWrongInAWholeBurst) {
    GooseDescription description;
    description.gocb_ref = "IED2LD0/LLN0$GO$Trip";
    description.dat_set = "IED2LD0/LLN0$Trip";
    description.data_set = {{DataNode::leaf("status", BasicType::boolean)}};
    GoosePublisher publisher{
        *GooseTemplate::create(address(), description), 1, {.timing = {1'000'000, 10'000'000, 2, 3, 30}}};
    publisher.start(0, 1'575'158'400'000'000'000);
    for (std::int64_t now = 0; now < 400'000'000; now += 500'000) {
        if (now == 100'000'000) {
            publisher.set(0, Value::of(true));
            publisher.commit(now, 1'575'158'400'100'000'000);
        }
        if (Octets const message = publisher.take(now); !message.empty()) {
            capture(message);
        }
    }
    expect_nothing_wrong();
    EXPECT_THAT(fields("goose.stNum goose.sqNum"),
                testing::AllOf(testing::StartsWith("1 0\n1 1\n"), HasSubstr("\n2 0\n2 1\n")));
}

TEST_F(Tshark, ComplainsWhenSomethingIsWrong) { // or the tests above could not fail
    auto frame = SvTemplate::create(address(), {asdu("MU", 12)});
    std::vector<std::uint8_t> damaged{frame->frame().begin(), frame->frame().end()};
    damaged[28] = 0x7F; // length of the APDU
    capture(damaged);
    EXPECT_NE(print("-Y '_ws.malformed || _ws.expert.severity >= 0x200000' -V"), "");
}

} // namespace
} // namespace gridspace::iec61850
