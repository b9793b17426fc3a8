// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The answers are those of linuxptp 3.1.1's ptp4l on a virtual cable, a grandmaster of class 6 and its slave; what they
// say is what pmc said of them in the same second.
#include "gateways/ptp/time_quality.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <string_view>

namespace gridspace::ptp {
namespace {

using Octets = std::vector<std::uint8_t>;
constexpr std::int64_t kMs = 1'000'000, kSecond = 1000 * kMs;

Octets octets(std::string_view hex) {
    Octets out;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
        out.push_back(static_cast<std::uint8_t>(std::stoi(std::string{hex.substr(i, 2)}, nullptr, 16)));
    }
    return out;
}

Octets const kSlaveStatus =
    octets("0d0200680000000000000000000000000000000046e76ffffe608aa400000007047f000000000000000000000000020000010034c00"
           "0fffffff"
           "ffffffec618ebbf1c786e7692000000000000000000000000000000000000000000000000000196652efffe31f136");
Octets const kSlaveParent = octets("0d0200560000000000000000000000000000000046e76ffffe608aa400000008047f000000000000000"
                                   "000000000020000010022200296652efff"
                                   "e31f13600010000ffff7fffffff010621ffff8096652efffe31f136");
Octets const kMasterStatus =
    octets("0d0200680000000000000000000000000000000096652efffe31f13600000007047f000000000000000000000000020000010034c00"
           "000000000"
           "000000000000000000000000000000000000000000000000000000000000000000000000000096652efffe31f136");
Octets const kMasterParent = octets("0d0200560000000000000000000000000000000096652efffe31f13600000008047f00000000000000"
                                    "0000000000020000010022200296652efff"
                                    "e31f13600000000ffff7fffffff010621ffff8096652efffe31f136");
constexpr ClockIdentity kMaster{0x96, 0x65, 0x2e, 0xff, 0xfe, 0x31, 0xf1, 0x36};
constexpr ClockIdentity kSlave{0x46, 0xe7, 0x6f, 0xff, 0xfe, 0x60, 0x8a, 0xa4};

TEST(Ptp, ReadsWhatADaemonSaysOfItsClock) {
    auto const status = decode_response(kSlaveStatus, 0), parent = decode_response(kSlaveParent, 0);
    ASSERT_TRUE(status && status->time_status && parent && parent->parent);
    EXPECT_EQ(status->from, kSlave);
    EXPECT_EQ(status->sequence, 7);
    EXPECT_EQ(status->time_status->master_offset_ns, -314);
    EXPECT_EQ(status->time_status->ingress_ns, 1795739005437769362);
    EXPECT_TRUE(status->time_status->grandmaster_present);
    EXPECT_EQ(status->time_status->grandmaster, kMaster);
    EXPECT_EQ(parent->parent->clock_class, 6);
    EXPECT_EQ(parent->parent->grandmaster, kMaster);
}

TEST(Ptp, AsksAsPmcDoes) {
    // what `pmc -z 'GET PARENT_DATA_SET'` sends, with port and sequence of ours
    EXPECT_EQ(management_get(ManagementId::parent_data_set, 0, 1),
              octets("0d02003600000000000000000000000000000000000000000000000000000001047fffffffffffffffffffff000000000"
                     "00100022002"));
}

TEST(Ptp, TakesNothingElseForAnAnswer) {
    for (Octets const& whole : {kSlaveStatus, kSlaveParent}) {
        for (std::size_t cut = 0; cut < whole.size(); ++cut) {
            EXPECT_FALSE(decode_response({whole.data(), cut}, 0)) << cut;
        }
        EXPECT_FALSE(decode_response(whole, 1)) << "another domain";
    }
    EXPECT_FALSE(decode_response(management_get(ManagementId::time_status, 0, 0), 0)) << "a question";
    Octets other = kSlaveStatus;
    other[53] = 7; // another data set
    EXPECT_FALSE(decode_response(other, 0));
    Octets shorter = kSlaveStatus;
    shorter[51] = 20; // less data than there has to be
    EXPECT_FALSE(decode_response(shorter, 0));
}

class Quality : public testing::Test {
  protected:
    void hear(Octets const& octets) { sut.hear(decode_response(octets, 0).value(), now); }
    /// What it says after so long of answers, four a second.
    std::uint8_t after(std::int64_t ns, Octets status, Octets const& parent, bool measures = true) {
        for (std::int64_t const end = now + ns; now < end; now += 250 * kMs) {
            odd_ = odd_ != measures;
            status[69] = odd_ ? 1 : 0; // within ingress_time
            hear(status);
            hear(parent);
            sut.look(now);
        }
        return sut.smp_synch();
    }
    std::uint8_t after_silence(std::int64_t ns) {
        now += ns;
        sut.look(now);
        return sut.smp_synch();
    }
    static Octets with_class(Octets parent, int clock_class) {
        parent[73] = static_cast<std::uint8_t>(clock_class);
        return parent;
    }
    /// 65,792 ns from its grandmaster.
    static Octets far_away(Octets status) {
        constexpr std::array<std::uint8_t, 8> kOffset{0, 0, 0, 0, 0, 1, 1, 0};
        std::copy(kOffset.begin(), kOffset.end(), status.begin() + 54);
        return status;
    }
    static Octets without_grandmaster(Octets status) {
        status[95] = 0;
        return status;
    }

    std::int64_t now{kSecond};
    TimeQuality sut{{}};

  private:
    bool odd_{false};
};

TEST_F(Quality, IsGlobalBehindAClockOfUtcAndLocalBehindAnother) {
    EXPECT_EQ(sut.smp_synch(), 0);
    EXPECT_EQ(after(kSecond, kSlaveStatus, kSlaveParent), 2);
    EXPECT_EQ(sut.text(), "follows clock 96652e.fffe.31f136 (class 6), -0.314 us away: smpSynch is 2");
    EXPECT_EQ(after(kSecond, kSlaveStatus, with_class(kSlaveParent, 7)), 2);
    for (int const clock_class : {13, 52, 187, 248}) {
        EXPECT_EQ(after(kSecond, kSlaveStatus, with_class(kSlaveParent, clock_class)), 1) << clock_class;
    }
}

TEST_F(Quality, OfAGrandmasterIsItsOwnClockAndOfOneThatOnlyFoundNobodyNone) {
    EXPECT_EQ(after(kSecond, kMasterStatus, kMasterParent), 2);
    EXPECT_EQ(sut.text(), "is clock 96652e.fffe.31f136 (class 6), 0.000 us away: smpSynch is 2");
    EXPECT_EQ(after(kSecond, kMasterStatus, with_class(kMasterParent, 13)), 1);
    EXPECT_EQ(after(10 * kSecond, kMasterStatus, with_class(kMasterParent, 248)), 0);
}

TEST_F(Quality, StaysAsItWasForTheHoldoverAndIsThenNone) {
    after(kSecond, kSlaveStatus, kSlaveParent);
    EXPECT_EQ(after(4 * kSecond, without_grandmaster(kSlaveStatus), kSlaveParent), 2);
    EXPECT_EQ(sut.state(), TimeQuality::State::holdover);
    EXPECT_EQ(sut.text(), "no grandmaster, holdover: smpSynch is 2");
    EXPECT_EQ(after(2 * kSecond, without_grandmaster(kSlaveStatus), kSlaveParent), 0);
    EXPECT_EQ(sut.text(), "no grandmaster, not synchronised any more: smpSynch is 0");
    EXPECT_EQ(after(250 * kMs, kSlaveStatus, kSlaveParent), 2) << "it comes back";
}

TEST_F(Quality, OfADaemonThatIsSilentIsItsHoldover) {
    after(kSecond, kSlaveStatus, kSlaveParent);
    EXPECT_EQ(after_silence(1200 * kMs), 2);
    EXPECT_EQ(sut.state(), TimeQuality::State::following) << "an answer or two may be late";
    EXPECT_EQ(after_silence(kSecond), 2);
    EXPECT_EQ(sut.text(), "the PTP daemon does not answer, holdover: smpSynch is 2");
    EXPECT_EQ(after_silence(5 * kSecond), 0);
}

TEST_F(Quality, IsNoneFarFromTheGrandmasterAndWithoutMeasurements) {
    EXPECT_EQ(after(kSecond, far_away(kSlaveStatus), kSlaveParent), 0);
    EXPECT_EQ(sut.state(), TimeQuality::State::never);
    after(kSecond, kSlaveStatus, kSlaveParent);
    EXPECT_EQ(after(10 * kSecond, far_away(kSlaveStatus), kSlaveParent), 0);
    EXPECT_EQ(sut.text().substr(0, 31), "65.792 us from its grandmaster,") << sut.text();
    after(kSecond, kSlaveStatus, kSlaveParent);
    EXPECT_EQ(after(10 * kSecond, kSlaveStatus, kSlaveParent, false), 0) << "its Sync messages are gone";
    EXPECT_EQ(sut.text(), "its grandmaster sends no time, not synchronised any more: smpSynch is 0");
}

TEST_F(Quality, AClockThatDoesNotComeIsToldOfOnce) {
    int told = 0;
    for (std::int64_t const end = now + 4 * TimeQuality::kPatienceNs; now < end; now += 250 * kMs) {
        told += sut.look(now) ? 1 : 0;
        EXPECT_EQ(told, now - kSecond >= TimeQuality::kPatienceNs ? 1 : 0);
    }
    EXPECT_EQ(sut.text(), "the PTP daemon does not answer, not synchronised yet: smpSynch is 0");
    after(kSecond, far_away(kSlaveStatus), kSlaveParent);
    EXPECT_EQ(sut.text(), "65.792 us from its grandmaster, not synchronised yet: smpSynch is 0");
    EXPECT_EQ(after(kSecond, kSlaveStatus, kSlaveParent), 2);
}

TEST_F(Quality, ChangesAreToldOnce) {
    hear(kSlaveStatus);
    EXPECT_FALSE(sut.look(now)) << "only half of it is known";
    hear(kSlaveParent);
    EXPECT_TRUE(sut.look(now));
    EXPECT_FALSE(sut.look(now));
}

} // namespace
} // namespace gridspace::ptp
